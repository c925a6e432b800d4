//! Users and sessions in the database.

use super::user::{Role, User, normal_email, user_sql};
use crate::audit::RequestContext;
use crate::client_address::Origin;
use crate::db::{Db, Result, Tx, execute, row, rows};
use crate::error;
use crate::ids::{SessionId, UserId};
use crate::secret;
use crate::tenants::Tenant;
use crate::time::Time;
use serde::Serialize;
use utoipa::ToSchema;

/// Minimum age of `last_seen_at` before it is updated, seconds: most requests write nothing.
const SEEN_NOTED_EVERY_S: f64 = 600.0;

#[derive(sqlx::FromRow)]
struct Stored {
    #[sqlx(flatten)]
    user: User,
    password_hash: String,
}

#[derive(sqlx::FromRow)]
struct Holder {
    #[sqlx(flatten)]
    user: User,
    session_id: SessionId,
    last_seen_at: Time,
}

/// Returns the user of a session that has neither expired nor been idle for `idle_s`.
pub async fn find_user(
    db: &Db,
    token_hash: &[u8],
    now: Time,
    idle_s: f64,
) -> Result<Option<(User, SessionId)>> {
    let holder = row!(
        db,
        Holder,
        concat!(
            user_sql!(", s.id AS session_id, s.last_seen_at"),
            "JOIN sessions s ON s.user_id = u.id
             WHERE s.token_hash = $1 AND s.expires_at > $2 AND s.last_seen_at > $3
               AND u.disabled_at IS NULL
             ORDER BY u.id"
        ),
        token_hash,
        now,
        Time(now.0.plus_seconds(-idle_s))
    )?;
    let Some(holder) = holder else {
        return Ok(None);
    };
    if now.0.seconds_since(holder.last_seen_at.0) >= SEEN_NOTED_EVERY_S {
        let mut tx = db.begin().await?;
        execute!(
            &mut tx,
            "UPDATE sessions SET last_seen_at = $2 WHERE id = $1",
            holder.session_id,
            now
        )?;
        tx.commit().await?;
    }
    Ok(Some((holder.user, holder.session_id)))
}

/// Checks whether a session is still valid.
///
/// # Errors
/// Fails when the database fails.
pub async fn is_valid(db: &Db, id: SessionId, now: Time) -> Result<bool> {
    let found = row!(
        db,
        (SessionId,),
        "SELECT s.id FROM sessions s
         JOIN users u ON u.id = s.user_id
         WHERE s.id = $1 AND s.expires_at > $2 AND u.disabled_at IS NULL
         ORDER BY s.id",
        id,
        now
    )?;
    Ok(found.is_some())
}

/// Returns the name of a user.
///
/// # Errors
/// Fails when there is no such user.
pub async fn name_of(tx: &mut Tx, id: UserId) -> error::Result<String> {
    let found = row!(
        in tx,
        (String,),
        "SELECT name FROM users WHERE id = $1 ORDER BY id",
        id
    )?;
    let (name,) = found.ok_or_else(|| anyhow::anyhow!("user {id} is missing"))?;
    Ok(name)
}

/// Returns the active user with an e-mail address, and the hash of the password.
pub(super) async fn find_by_email(db: &Db, email: &str) -> Result<Option<(User, String)>> {
    let stored = row!(
        db,
        Stored,
        concat!(
            user_sql!(", u.password_hash"),
            "WHERE u.email = $1 AND u.disabled_at IS NULL ORDER BY u.id"
        ),
        email
    )?;
    Ok(stored.map(|stored| (stored.user, stored.password_hash)))
}

/// Session of the signed-in user.
#[derive(Serialize, ToSchema, sqlx::FromRow)]
pub(crate) struct Session {
    /// The session's id.
    pub(crate) id: SessionId,
    /// Time of the sign-in.
    created_at: Time,
    /// Time of the last request, to ten minutes.
    last_seen_at: Time,
    /// Latest end of the session.
    expires_at: Time,
    /// Network address of the sign-in; empty if unknown.
    #[schema(example = "198.51.100.7")]
    address: String,
    /// Name that the browser gives itself (`User-Agent`).
    user_agent: String,
    /// Provider of the sign-in; none for a sign-in by password.
    #[schema(required, example = json!(null))]
    provider: Option<String>,
    /// True for the session of this request.
    pub(crate) current: bool,
}

/// Session to be opened.
pub(super) struct NewSession<'a> {
    pub(super) token: &'a str,
    /// Provider of the sign-in; none for a sign-in by password.
    pub(super) provider: Option<&'a str>,
    pub(super) now: Time,
    pub(super) expires_at: Time,
}

/// Opens a session, and deletes expired ones.
pub(super) async fn open(
    tx: &mut Tx,
    user: &User,
    from: &Origin,
    new: &NewSession<'_>,
) -> Result<()> {
    let now = new.now;
    execute!(&mut *tx, "DELETE FROM sessions WHERE expires_at <= $1", now)?;
    execute!(
        tx,
        "INSERT INTO sessions (id, user_id, token_hash, created_at, last_seen_at, expires_at,
                               address, user_agent, provider)
         VALUES ($1, $2, $3, $4, $4, $5, $6, $7, $8)",
        SessionId::new(),
        user.user_id,
        secret::hash(new.token),
        now,
        new.expires_at,
        from.address_text(),
        from.program.as_str(),
        new.provider
    )?;
    Ok(())
}

pub(crate) async fn list(
    db: &Db,
    user: UserId,
    now: Time,
    idle_s: f64,
    after: Option<uuid::Uuid>,
    limit: i64,
) -> Result<Vec<Session>> {
    rows!(
        db,
        Session,
        "SELECT id, created_at, last_seen_at, expires_at, address, user_agent, provider,
                FALSE AS current
         FROM sessions
         WHERE user_id = $1 AND expires_at > $2 AND last_seen_at > $3 AND id > $4
         ORDER BY id
         LIMIT $5",
        user,
        now,
        Time(now.0.plus_seconds(-idle_s)),
        after.unwrap_or_default(),
        limit
    )
}

/// Ends one of a user's sessions; false when the user has no such session.
pub(crate) async fn end(request: &RequestContext, user: UserId, id: SessionId) -> Result<bool> {
    let mut tx = request.begin().await?;
    let ended = execute!(
        &mut tx,
        "DELETE FROM sessions WHERE user_id = $1 AND id = $2",
        user,
        id
    )?;
    tx.commit().await?;
    Ok(ended > 0)
}

/// Ends all sessions of a user except the one to be kept.
pub async fn end_all(tx: &mut Tx, user: UserId, kept: Option<SessionId>) -> Result<()> {
    execute!(
        tx,
        "DELETE FROM sessions WHERE user_id = $1 AND id <> $2",
        user,
        kept.map_or(uuid::Uuid::nil(), |kept| kept.0)
    )?;
    Ok(())
}

/// Replaces the password.
pub async fn set_password(tx: &mut Tx, user: UserId, password_hash: &str) -> Result<()> {
    execute!(
        tx,
        "UPDATE users SET password_hash = $2 WHERE id = $1",
        user,
        password_hash
    )?;
    Ok(())
}

/// Stores a new user of a tenant, or of none. The e-mail address must be new.
pub async fn create_user(
    tx: &mut Tx,
    tenant: Option<Tenant>,
    email: &str,
    name: &str,
    role: Role,
    password_hash: &str,
    now: Time,
) -> Result<UserId> {
    let id = UserId::new();
    execute!(
        tx,
        "INSERT INTO users (id, operator_id, firm_id, email, name, role, password_hash, created_at)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8)",
        id,
        tenant.and_then(Tenant::operator),
        tenant.and_then(Tenant::firm),
        normal_email(email),
        name,
        role,
        password_hash,
        now
    )?;
    Ok(id)
}
