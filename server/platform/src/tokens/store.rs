//! API tokens in the database.

use super::made::remove_made;
use super::{PREFIX, Scope, Token};
use crate::db::{Db, Result, Tx, execute, row, rows};
use crate::error::{self, Error};
use crate::ids::{TokenId, UserId};
use crate::secret;
use crate::session::{User, user_sql};
use crate::tenants::Tenant;
use crate::time::Time;
use futures_util::future::BoxFuture;

/// Minimum age of `last_used_at` before it is updated, seconds: most requests write nothing.
const USE_NOTED_EVERY_S: f64 = 3600.0;

/// User for whom a token acts.
#[derive(sqlx::FromRow)]
pub(crate) struct Holder {
    #[sqlx(flatten)]
    pub(crate) user: User,
    pub(crate) token_id: TokenId,
    pub(crate) scope: Scope,
    last_used_at: Option<Time>,
}

/// Returns the user for whom a valid token acts, and notes its use.
pub(crate) async fn find_holder(db: &Db, token: &str, now: Time) -> Result<Option<Holder>> {
    if !token.starts_with(PREFIX) {
        return Ok(None);
    }
    let holder = row!(
        db,
        Holder,
        concat!(
            user_sql!(", t.id AS token_id, t.scope, t.last_used_at"),
            "JOIN api_tokens t ON t.user_id = u.id
             WHERE t.token_hash = $1 AND t.expires_at > $2 AND u.disabled_at IS NULL
             ORDER BY t.id"
        ),
        secret::hash(token),
        now
    )?;
    let Some(holder) = holder else {
        return Ok(None);
    };
    let noted = holder
        .last_used_at
        .is_some_and(|at| now.0.seconds_since(at.0) < USE_NOTED_EVERY_S);
    if !noted {
        note_use(db, holder.token_id, now).await?;
    }
    Ok(Some(holder))
}

/// Checks whether a token is still valid.
///
/// # Errors
/// Fails when the database fails.
pub async fn is_valid(db: &Db, id: TokenId, now: Time) -> Result<bool> {
    let found = row!(
        db,
        (TokenId,),
        "SELECT t.id FROM api_tokens t
         JOIN users u ON u.id = t.user_id
         WHERE t.id = $1 AND t.expires_at > $2 AND u.disabled_at IS NULL
         ORDER BY t.id",
        id,
        now
    )?;
    Ok(found.is_some())
}

async fn note_use(db: &Db, id: TokenId, now: Time) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "UPDATE api_tokens SET last_used_at = $2 WHERE id = $1",
        id,
        now
    )?;
    tx.commit().await
}

pub(crate) async fn list(
    db: &Db,
    user: UserId,
    after: Option<uuid::Uuid>,
    limit: i64,
) -> Result<Vec<Token>> {
    rows!(
        db,
        Token,
        "SELECT id, name, scope, expires_at, created_at, last_used_at
         FROM api_tokens
         WHERE user_id = $1 AND id > $2
         ORDER BY id
         LIMIT $3",
        user,
        after.unwrap_or_default(),
        limit
    )
}

pub(crate) async fn insert(tx: &mut Tx, user: UserId, token: &Token, hash: &[u8]) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO api_tokens (id, user_id, token_hash, name, scope, created_at, expires_at)
         VALUES ($1, $2, $3, $4, $5, $6, $7)",
        token.id,
        user,
        hash,
        token.name.as_str(),
        token.scope,
        token.created_at,
        token.expires_at
    )?;
    Ok(())
}

/// Revokes a token; what it made stays.
///
/// # Errors
/// [`Error::NotFound`] when the user has no such token.
pub(crate) async fn delete(tx: &mut Tx, user: UserId, id: TokenId) -> error::Result<()> {
    let deleted = execute!(
        tx,
        "DELETE FROM api_tokens WHERE user_id = $1 AND id = $2",
        user,
        id
    )?;
    if deleted == 0 {
        return Err(Error::NotFound("token"));
    }
    Ok(())
}

/// Revokes a token, and removes what it made.
///
/// # Errors
/// [`Error::NotFound`] when the user has no such token.
pub(crate) async fn delete_with_made(tx: &mut Tx, user: UserId, id: TokenId) -> error::Result<()> {
    delete(tx, user, id).await?;
    remove_made(tx, id).await
}

/// Revokes all of a user's tokens.
///
/// # Errors
/// Fails when the database fails.
pub async fn delete_all(tx: &mut Tx, user: UserId) -> Result<u64> {
    execute!(tx, "DELETE FROM api_tokens WHERE user_id = $1", user)
}

/// Counts the API tokens of a tenant.
pub(super) fn count(tx: &mut Tx, tenant: Tenant, _: Time) -> BoxFuture<'_, Result<i64>> {
    Box::pin(async move {
        let found = row!(
            in tx,
            (i64,),
            "SELECT COUNT(*) FROM api_tokens t JOIN users u ON u.id = t.user_id
             WHERE u.operator_id = $1 OR u.firm_id = $2",
            tenant.operator(),
            tenant.firm()
        )?;
        Ok(found.map_or(0, |(count,)| count))
    })
}
