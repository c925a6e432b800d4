//! A second factor for those who want one, or whose operator wants it: codes from an
//! authenticator app (RFC 6238), and recovery codes for when the telephone is gone.
//!
//! Invariants: a code works once; recovery codes are stored as hashes and each
//! works once; a factor counts only after a first code has come, so that nobody locks
//! themselves out; the password is asked for again before anything of it changes.

mod store;
pub(crate) mod totp;

pub(crate) use store::{begin, confirm, set_recovery_codes};

use crate::audit::RequestContext;
use crate::db::Tx;
use crate::error::Result;
use crate::ids::UserId;
use binnacle_compass::time::Timestamp;

/// Checks a code of the user's, from the app or a recovery code, and marks it as used.
///
/// # Errors
/// When the database does.
pub async fn use_code(
    request: &RequestContext,
    user: UserId,
    code: &str,
    now: Timestamp,
) -> Result<bool> {
    let mut tx = request.begin().await?;
    let used = store::use_code(&mut tx, user, code, now).await?
        || store::use_recovery_code(&mut tx, user, code).await?;
    tx.commit().await?;
    Ok(used)
}

/// Takes a user's second factor away; false when there was none.
///
/// # Errors
/// When the database does.
pub async fn remove(tx: &mut Tx, user: UserId) -> Result<bool> {
    Ok(store::remove(tx, user).await?)
}
