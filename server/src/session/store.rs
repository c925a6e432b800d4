//! Users and their sessions in the database.

use crate::db::{Db, Result, Tx, execute, row};
use crate::error;
use crate::ids::{OperatorId, UserId};
use crate::secret;
use crate::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A user, as `/me` shows it.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = Me)]
pub struct User {
    /// The user's id.
    pub user_id: UserId,
    /// What the user signs in with.
    pub email: String,
    /// The user's name.
    pub name: String,
    /// What the user may do.
    pub role: Role,
    /// The operator whose fleet the user sees; none for a platform admin.
    #[schema(required)]
    pub operator_id: Option<OperatorId>,
    /// That operator's name.
    #[schema(required)]
    pub operator_name: Option<String>,
}

/// What a user may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub enum Role {
    /// See and change the operator's fleet.
    Admin,
    /// See the operator's fleet.
    Viewer,
    /// Manage operators.
    PlatformAdmin,
}

impl Role {
    /// Whether the role allows changes to a fleet.
    pub fn may_change_fleet(self) -> bool {
        self == Role::Admin
    }
}

#[derive(sqlx::FromRow)]
struct Stored {
    #[sqlx(flatten)]
    user: User,
    password_hash: String,
}

/// An e-mail as it is stored and compared.
pub(super) fn normal_email(email: &str) -> String {
    email.trim().to_lowercase()
}

/// The user whose session this is, if it has not ended.
pub async fn find_user(db: &Db, token_hash: &[u8], now: Time) -> Result<Option<User>> {
    row!(
        db,
        User,
        "SELECT u.id AS user_id, u.email, u.name, u.role, u.operator_id, o.name AS operator_name
         FROM sessions s
         JOIN users u ON u.id = s.user_id
         LEFT JOIN operators o ON o.id = u.operator_id
         WHERE s.token_hash = $1 AND s.expires_at > $2
         ORDER BY u.id",
        token_hash,
        now
    )
}

/// A user's name.
///
/// # Errors
/// When there is no such user.
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

pub(super) async fn find_by_email(db: &Db, email: &str) -> Result<Option<(User, String)>> {
    let stored = row!(
        db,
        Stored,
        "SELECT u.id AS user_id, u.email, u.name, u.role, u.operator_id, o.name AS operator_name,
                u.password_hash
         FROM users u
         LEFT JOIN operators o ON o.id = u.operator_id
         WHERE u.email = $1
         ORDER BY u.id",
        email
    )?;
    Ok(stored.map(|stored| (stored.user, stored.password_hash)))
}

/// Opens a session; clears away those that ended, and the e-mail's failures.
pub(super) async fn open(
    db: &Db,
    user: &User,
    email: &str,
    token: &str,
    now: Time,
    expires_at: Time,
) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(&mut tx, "DELETE FROM sessions WHERE expires_at <= $1", now)?;
    execute!(
        &mut tx,
        "DELETE FROM login_failures WHERE email_hash = $1",
        secret::hash(email)
    )?;
    execute!(
        &mut tx,
        "INSERT INTO sessions (token_hash, user_id, created_at, expires_at)
         VALUES ($1, $2, $3, $4)",
        secret::hash(token),
        user.user_id,
        now,
        expires_at
    )?;
    tx.commit().await
}

pub(super) async fn close(db: &Db, token_hash: &[u8]) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "DELETE FROM sessions WHERE token_hash = $1",
        token_hash
    )?;
    tx.commit().await
}

/// Stores a new user; the e-mail must be new.
pub async fn create_user(
    tx: &mut Tx,
    operator_id: Option<OperatorId>,
    email: &str,
    name: &str,
    role: Role,
    password_hash: &str,
    now: Time,
) -> Result<UserId> {
    let id = UserId::new();
    execute!(
        tx,
        "INSERT INTO users (id, operator_id, email, name, role, password_hash, created_at)
         VALUES ($1, $2, $3, $4, $5, $6, $7)",
        id,
        operator_id,
        normal_email(email),
        name,
        role,
        password_hash,
        now
    )?;
    Ok(id)
}
