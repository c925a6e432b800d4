//! The server's keys in the database.

use super::{PublishedKey, ServerKey};
use crate::db::{self, Db, Tx, execute, row, rows};
use crate::error::Result;
use crate::sealing::{Seals, StoredSecret};
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
        StoredKey,
        "SELECT public_key, secret, sealed_by FROM signing_keys WHERE retired_at IS NULL
         ORDER BY created_at DESC, public_key LIMIT 1"
    )?;
    match found {
        Some(stored) => stored.open(tx.seals()),
        None => Ok(insert(tx, now).await?),
    }
}

/// Key as it is stored, sealed or not.
#[derive(sqlx::FromRow)]
struct StoredKey {
    public_key: String,
    secret: Vec<u8>,
    sealed_by: Option<String>,
}

impl StoredKey {
    fn open(self, seals: &Seals) -> Result<ServerKey> {
        let stored = StoredSecret {
            bytes: self.secret,
            sealed_by: self.sealed_by,
        };
        let secret = seals
            .open(&row_of(&self.public_key), &stored)
            .map_err(sqlx::Error::from)?;
        let key = ServerKey::from_secret(&secret);
        Ok(key.ok_or_else(|| anyhow::anyhow!("the signing key {} is damaged", self.public_key))?)
    }
}

/// Returns the name of a key, to which its seal is bound.
fn row_of(public_key: &str) -> String {
    format!("signing key {public_key}")
}

/// Returns the key that signs now, outside a transaction. Only the first one is written.
///
/// # Errors
/// Fails when the database fails.
pub async fn of_server(db: &Db, now: Time) -> Result<ServerKey> {
    let found = row!(
        db,
        StoredKey,
        "SELECT public_key, secret, sealed_by FROM signing_keys WHERE retired_at IS NULL
         ORDER BY created_at DESC, public_key LIMIT 1"
    )?;
    if let Some(stored) = found {
        return stored.open(db.seals());
    }
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
    let stored = tx.seals().seal(&row_of(&key.public_key()), &secret);
    execute!(
        tx,
        "INSERT INTO signing_keys (public_key, secret, sealed_by, created_at)
         VALUES ($1, $2, $3, $4)",
        key.public_key(),
        stored.bytes,
        stored.sealed_by,
        now
    )?;
    Ok(key)
}

/// Seals the keys that the present sealing key has not sealed, and returns their number.
pub(crate) async fn reseal(tx: &mut Tx) -> db::Result<u64> {
    let current = tx.seals().current().map(str::to_owned);
    let found = rows!(
        in &mut *tx,
        (String, Vec<u8>, Option<String>),
        "SELECT public_key, secret, sealed_by FROM signing_keys
         WHERE COALESCE(sealed_by, '') <> COALESCE($1, '') ORDER BY public_key",
        current
    )?;
    let mut sealed = 0;
    for (public_key, bytes, sealed_by) in found {
        let row = row_of(&public_key);
        let secret = tx.seals().open(&row, &StoredSecret { bytes, sealed_by })?;
        let stored = tx.seals().seal(&row, &secret);
        sealed += execute!(
            &mut *tx,
            "UPDATE signing_keys SET secret = $2, sealed_by = $3 WHERE public_key = $1",
            public_key,
            stored.bytes,
            stored.sealed_by
        )?;
    }
    Ok(sealed)
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
