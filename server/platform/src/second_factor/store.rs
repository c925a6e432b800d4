//! Second factors and recovery codes in the database.

use super::totp;
use crate::audit::RequestContext;
use crate::db::{Result, Tx, execute, row, rows};
use crate::ids::UserId;
use crate::sealing::StoredSecret;
use crate::secret;
use crate::time::Time;
use binnacle_compass::time::Timestamp;

/// Step before all others.
const NEVER: i64 = -1;

#[derive(sqlx::FromRow)]
struct Factor {
    secret: Vec<u8>,
    sealed_by: Option<String>,
    last_step: i64,
}

/// Returns the name of a user's factor, to which its seal is bound.
fn row_of(user: UserId) -> String {
    format!("second factor of {user}")
}

/// Stores an unconfirmed secret in place of any other unconfirmed one; false when a confirmed
/// one exists.
pub(crate) async fn begin(
    request: &RequestContext,
    user: UserId,
    secret: &[u8],
    now: Time,
) -> Result<bool> {
    let mut tx = request.begin().await?;
    let stored = tx.seals().seal(&row_of(user), secret);
    let kept = execute!(
        &mut tx,
        "INSERT INTO second_factors (user_id, secret, sealed_by, created_at, confirmed_at, last_step)
         VALUES ($1, $2, $3, $4, NULL, $5)
         ON CONFLICT (user_id) DO UPDATE
         SET secret = excluded.secret, sealed_by = excluded.sealed_by,
             created_at = excluded.created_at
         WHERE second_factors.confirmed_at IS NULL",
        user,
        stored.bytes,
        stored.sealed_by,
        now,
        NEVER
    )?;
    tx.commit().await?;
    Ok(kept > 0)
}

/// Confirms the stored secret by its first code.
pub(crate) async fn confirm(tx: &mut Tx, user: UserId, code: &str, now: Timestamp) -> Result<bool> {
    if !use_code(tx, user, code, now).await? {
        return Ok(false);
    }
    let confirmed = execute!(
        tx,
        "UPDATE second_factors SET confirmed_at = $2
         WHERE user_id = $1 AND confirmed_at IS NULL",
        user,
        Time(now)
    )?;
    Ok(confirmed > 0)
}

/// Uses a current code. It works once, even if it is sent twice at the same time.
pub(super) async fn use_code(
    tx: &mut Tx,
    user: UserId,
    code: &str,
    now: Timestamp,
) -> Result<bool> {
    let factor = row!(
        in &mut *tx,
        Factor,
        "SELECT secret, sealed_by, last_step FROM second_factors
         WHERE user_id = $1 ORDER BY user_id",
        user
    )?;
    let Some(Factor {
        secret: bytes,
        sealed_by,
        last_step,
    }) = factor
    else {
        return Ok(false);
    };
    let stored = StoredSecret { bytes, sealed_by };
    let secret = tx.seals().open(&row_of(user), &stored)?;
    let Some(step) = totp::step_of(&secret, code, last_step, now) else {
        return Ok(false);
    };
    let used = execute!(
        tx,
        "UPDATE second_factors SET last_step = $2 WHERE user_id = $1 AND last_step < $2",
        user,
        step
    )?;
    Ok(used > 0)
}

/// Seals the secrets that the present key has not sealed, and returns their number.
pub(crate) async fn reseal(tx: &mut Tx) -> Result<u64> {
    let current = tx.seals().current().map(str::to_owned);
    let found = rows!(
        in &mut *tx,
        (UserId, Vec<u8>, Option<String>),
        "SELECT user_id, secret, sealed_by FROM second_factors
         WHERE COALESCE(sealed_by, '') <> COALESCE($1, '') ORDER BY user_id",
        current
    )?;
    let mut sealed = 0;
    for (user, bytes, sealed_by) in found {
        let row = row_of(user);
        let found = StoredSecret { bytes, sealed_by };
        let secret = tx.seals().open(&row, &found)?;
        let stored = tx.seals().seal(&row, &secret);
        // A person may have begun with another secret in the meantime.
        sealed += execute!(
            &mut *tx,
            "UPDATE second_factors SET secret = $2, sealed_by = $3
             WHERE user_id = $1 AND secret = $4",
            user,
            stored.bytes,
            stored.sealed_by,
            found.bytes
        )?;
    }
    Ok(sealed)
}

/// Uses up a recovery code.
pub(super) async fn use_recovery_code(tx: &mut Tx, user: UserId, code: &str) -> Result<bool> {
    let used = execute!(
        tx,
        "DELETE FROM recovery_codes WHERE user_id = $1 AND code_hash = $2",
        user,
        secret::hash(&secret::normal_code(code))
    )?;
    Ok(used > 0)
}

/// Replaces the recovery codes.
pub(crate) async fn set_recovery_codes(tx: &mut Tx, user: UserId, codes: &[String]) -> Result<()> {
    execute!(
        &mut *tx,
        "DELETE FROM recovery_codes WHERE user_id = $1",
        user
    )?;
    for code in codes {
        execute!(
            &mut *tx,
            "INSERT INTO recovery_codes (user_id, code_hash) VALUES ($1, $2)",
            user,
            secret::hash(&secret::normal_code(code))
        )?;
    }
    Ok(())
}

/// Removes the second factor; false when there was none.
pub(super) async fn remove(tx: &mut Tx, user: UserId) -> Result<bool> {
    execute!(
        &mut *tx,
        "DELETE FROM recovery_codes WHERE user_id = $1",
        user
    )?;
    let removed = execute!(tx, "DELETE FROM second_factors WHERE user_id = $1", user)?;
    Ok(removed > 0)
}
