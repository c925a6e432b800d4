//! Second factor: codes from an authenticator app (RFC 6238), and recovery codes for a lost
//! phone. Users may set one up, and an operator may require it.
//!
//! Invariants: a code works once. Recovery codes are stored as hashes, and each works once. A
//! factor is active only after a first code has confirmed it, so that nobody locks themselves
//! out. Every change requires the password.

mod store;
pub(crate) mod totp;

pub(crate) use store::{begin, confirm, reseal, set_recovery_codes};

use crate::audit::RequestContext;
use crate::db::Tx;
use crate::error::Result;
use crate::ids::UserId;
use binnacle_compass::time::Timestamp;

/// Checks a user's code, from the app or a recovery code, and marks it as used.
///
/// # Errors
/// Fails when the database fails.
pub async fn use_code(
    request: &RequestContext,
    user: UserId,
    code: &str,
    now: Timestamp,
) -> Result<bool> {
    let mut tx = request.begin().await?;
    let used = store::use_code(&mut tx, user, code, now).await?
        || store::use_recovery_code(&mut tx, user, code).await?;
    // A wrong code changes nothing; its failure is counted, and audited, by the caller.
    if used {
        tx.commit().await?;
    }
    Ok(used)
}

/// Removes a user's second factor; false when there was none.
///
/// # Errors
/// Fails when the database fails.
pub async fn remove(tx: &mut Tx, user: UserId) -> Result<bool> {
    Ok(store::remove(tx, user).await?)
}
