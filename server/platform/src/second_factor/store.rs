//! Second factors and recovery codes in the database.

use super::totp;
use crate::audit::RequestContext;
use crate::db::{Result, Tx, execute, row};
use crate::ids::UserId;
use crate::secret;
use crate::time::Time;
use binnacle_compass::time::Timestamp;

/// Step before all others.
const NEVER: i64 = -1;

#[derive(sqlx::FromRow)]
struct Factor {
    secret: Vec<u8>,
    last_step: i64,
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
    let kept = execute!(
        &mut tx,
        "INSERT INTO second_factors (user_id, secret, created_at, confirmed_at, last_step)
         VALUES ($1, $2, $3, NULL, $4)
         ON CONFLICT (user_id) DO UPDATE
         SET secret = excluded.secret, created_at = excluded.created_at
         WHERE second_factors.confirmed_at IS NULL",
        user,
        secret,
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
        "SELECT secret, last_step FROM second_factors WHERE user_id = $1 ORDER BY user_id",
        user
    )?;
    let step = factor.and_then(|factor| totp::step_of(&factor.secret, code, factor.last_step, now));
    let Some(step) = step else {
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
