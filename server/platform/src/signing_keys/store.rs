//! The server's keys in the database.

use super::{PublishedKey, ServerKey};
use crate::db::{self, Db, Tx, execute, row, rows};
use crate::error::Result;
use crate::secret;
use crate::time::Time;
use ed25519_dalek::SigningKey;

/// Returns the key that signs now. The first one is made when it is needed.
///
/// # Errors
/// Fails when the database fails.
pub async fn current(tx: &mut Tx, now: Time) -> Result<ServerKey> {
    let found = row!(
        in &mut *tx,
        (Vec<u8>,),
        "SELECT secret FROM signing_keys WHERE retired_at IS NULL
         ORDER BY created_at DESC, public_key LIMIT 1"
    )?;
    match found.and_then(|(secret,)| ServerKey::from_secret(&secret)) {
        Some(key) => Ok(key),
        None => Ok(insert(tx, now).await?),
    }
}

/// Returns the key that signs now, outside a transaction.
///
/// # Errors
/// Fails when the database fails.
pub async fn of_server(db: &Db, now: Time) -> Result<ServerKey> {
    let mut tx = db.begin().await?;
    let key = current(&mut tx, now).await?;
    tx.commit().await?;
    Ok(key)
}

/// Retires the key that signs now, and makes the next.
///
/// # Errors
/// Fails when the database fails.
pub async fn rotate(tx: &mut Tx, now: Time) -> Result<ServerKey> {
    execute!(
        &mut *tx,
        "UPDATE signing_keys SET retired_at = $1 WHERE retired_at IS NULL",
        now
    )?;
    Ok(insert(tx, now).await?)
}

async fn insert(tx: &mut Tx, now: Time) -> db::Result<ServerKey> {
    let secret = secret::random::<32>();
    let key = ServerKey(SigningKey::from_bytes(&secret));
    execute!(
        tx,
        "INSERT INTO signing_keys (public_key, secret, created_at) VALUES ($1, $2, $3)",
        key.public_key(),
        secret.as_slice(),
        now
    )?;
    Ok(key)
}

/// Lists the public keys, the oldest first.
///
/// # Errors
/// Fails when the database fails.
pub async fn list(db: &Db) -> db::Result<Vec<PublishedKey>> {
    rows!(
        db,
        PublishedKey,
        "SELECT public_key, created_at, retired_at FROM signing_keys
         ORDER BY created_at, public_key"
    )
}
