//! Users bound to the provider, and returns from it, in the database.

use crate::audit::RequestContext;
use crate::db::{Db, Result, Tx, execute, row};
use crate::ids::UserId;
use crate::session::{User, user_sql};
use crate::time::Time;

/// Returns the user who is bound to a subject of the provider.
pub(super) async fn find_bound_user(
    db: &Db,
    issuer: &str,
    subject: &str,
) -> Result<Option<BoundUser>> {
    let known = row!(
        db,
        (UserId,),
        "SELECT user_id FROM identities WHERE issuer = $1 AND subject = $2 ORDER BY user_id",
        issuer,
        subject
    )?;
    let Some((id,)) = known else {
        return Ok(None);
    };
    Ok(Some(match find_user(db, id).await? {
        Some(user) => BoundUser::User(Box::new(user)),
        None => BoundUser::Disabled,
    }))
}

/// User who is bound to a subject of the provider.
pub(super) enum BoundUser {
    /// User who may sign in.
    User(Box<User>),
    /// User who is disabled.
    Disabled,
}

async fn find_user(db: &Db, id: UserId) -> Result<Option<User>> {
    row!(
        db,
        User,
        concat!(
            user_sql!(""),
            "WHERE u.id = $1 AND u.disabled_at IS NULL ORDER BY u.id"
        ),
        id
    )
}

/// Returns the active user with an e-mail address.
pub(super) async fn find_by_email(db: &Db, email: &str) -> Result<Option<User>> {
    row!(
        db,
        User,
        concat!(
            user_sql!(""),
            "WHERE u.email = $1 AND u.disabled_at IS NULL ORDER BY u.id"
        ),
        email
    )
}

/// Binds a user to a subject of the provider; false when either is already bound.
pub(super) async fn bind(
    tx: &mut Tx,
    issuer: &str,
    subject: &str,
    user: UserId,
    now: Time,
) -> Result<bool> {
    let bound = execute!(
        tx,
        "INSERT INTO identities (issuer, subject, user_id, created_at)
         VALUES ($1, $2, $3, $4)
         ON CONFLICT DO NOTHING",
        issuer,
        subject,
        user,
        now
    )?;
    Ok(bound > 0)
}

/// Removes the binding of a user.
pub async fn forget(tx: &mut Tx, user: UserId) -> Result<()> {
    execute!(tx, "DELETE FROM identities WHERE user_id = $1", user).map(drop)
}

/// Notes the return of a sign-in; false when it returned before.
pub(super) async fn note_return(
    request: &RequestContext,
    state_hash: &[u8],
    now: Time,
    expires_at: Time,
) -> Result<bool> {
    let mut tx = request.begin().await?;
    execute!(
        &mut tx,
        "DELETE FROM provider_returns WHERE expires_at <= $1",
        now
    )?;
    let noted = execute!(
        &mut tx,
        "INSERT INTO provider_returns (state_hash, expires_at) VALUES ($1, $2)
         ON CONFLICT DO NOTHING",
        state_hash,
        expires_at
    )?;
    tx.commit().await?;
    Ok(noted > 0)
}

/// Notes the user whose code a sign-in is waiting for.
pub(super) async fn await_code(
    request: &RequestContext,
    state_hash: &[u8],
    user: UserId,
) -> Result<()> {
    let mut tx = request.begin().await?;
    execute!(
        &mut tx,
        "UPDATE provider_returns SET user_id = $2 WHERE state_hash = $1",
        state_hash,
        user
    )?;
    tx.commit().await
}

/// Returns the user whose code a sign-in is waiting for.
pub(super) async fn awaited(db: &Db, state_hash: &[u8], now: Time) -> Result<Option<User>> {
    let found = row!(
        db,
        (Option<UserId>,),
        "SELECT user_id FROM provider_returns
         WHERE state_hash = $1 AND expires_at > $2 ORDER BY state_hash",
        state_hash,
        now
    )?;
    match found {
        Some((Some(id),)) => find_user(db, id).await,
        _ => Ok(None),
    }
}

/// Notes that a sign-in no longer waits for a code; false when it did not wait.
pub(super) async fn take_awaited(request: &RequestContext, state_hash: &[u8]) -> Result<bool> {
    let mut tx = request.begin().await?;
    let taken = execute!(
        &mut tx,
        "UPDATE provider_returns SET user_id = NULL
         WHERE state_hash = $1 AND user_id IS NOT NULL",
        state_hash
    )?;
    tx.commit().await?;
    Ok(taken > 0)
}
