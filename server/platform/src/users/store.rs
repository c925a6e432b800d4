//! Users of an operator in the database.

use super::{Person, SignInRules, codes};
use crate::db::{self, Db, Tx, execute, row, rows};
use crate::error::{Error, Result};
use crate::ids::{OperatorId, UserId};
use crate::outbox;
use crate::session::{self, Role};
use crate::tenants::Tenant;
use crate::time::Time;
use futures_util::future::BoxFuture;
use uuid::Uuid;

/// SQL that selects the columns of a [`Person`].
macro_rules! person_sql {
    () => {
        "SELECT u.id, u.email, u.name, u.role,
                CASE WHEN u.disabled_at IS NOT NULL THEN 'disabled'
                     WHEN u.password_hash = '' AND NOT EXISTS
                          (SELECT 1 FROM identities n WHERE n.user_id = u.id) THEN 'invited'
                     ELSE 'active' END AS state,
                y.confirmed_at IS NOT NULL AS second_factor, u.created_at,
                (SELECT MAX(s.last_seen_at) FROM sessions s WHERE s.user_id = u.id)
                    AS last_seen_at,
                i.expires_at AS invitation_expires_at
         FROM users u
         LEFT JOIN second_factors y ON y.user_id = u.id
         LEFT JOIN invitations i ON i.user_id = u.id "
    };
}

pub(super) async fn list(
    db: &Db,
    operator: OperatorId,
    after: Option<Uuid>,
    limit: i64,
) -> db::Result<Vec<Person>> {
    rows!(
        db,
        Person,
        concat!(
            person_sql!(),
            "WHERE u.operator_id = $1 AND u.id > $2 ORDER BY u.id LIMIT $3"
        ),
        operator,
        after.unwrap_or_default(),
        limit
    )
}

pub(super) async fn find(
    tx: &mut Tx,
    operator: OperatorId,
    id: UserId,
) -> db::Result<Option<Person>> {
    row!(
        in tx,
        Person,
        concat!(person_sql!(), "WHERE u.operator_id = $1 AND u.id = $2 ORDER BY u.id"),
        operator,
        id
    )
}

/// Stores a user without a password; `None` when the e-mail address has an account.
pub(super) async fn insert(
    tx: &mut Tx,
    tenant: Tenant,
    email: &str,
    name: &str,
    role: Role,
    now: Time,
) -> db::Result<Option<UserId>> {
    match session::create_user(tx, Some(tenant), email, name, role, "", now).await {
        Err(sqlx::Error::Database(error)) if error.is_unique_violation() => Ok(None),
        created => created.map(Some),
    }
}

/// Serialises changes to an operator's users, so that two admins cannot remove each other at
/// the same time.
pub(super) async fn lock(tx: &mut Tx, operator: OperatorId) -> db::Result<()> {
    execute!(
        tx,
        "UPDATE operators SET name = name WHERE id = $1",
        operator
    )
    .map(drop)
}

/// Refuses to leave an operator without an admin who can sign in.
pub(super) async fn must_have_admin(tx: &mut Tx, operator: OperatorId) -> Result<()> {
    if !has_admin(tx, operator).await? {
        let last = "no admin with a password would be left";
        return Err(Error::WrongState(last.to_owned()));
    }
    Ok(())
}

/// Tells whether an operator has an admin who can sign in, with a password or by a provider.
pub(super) async fn has_active_admin(tx: &mut Tx, operator: OperatorId) -> db::Result<bool> {
    let found = row!(
        in tx,
        (UserId,),
        "SELECT u.id FROM users u
         WHERE u.operator_id = $1 AND u.role = 'admin' AND u.disabled_at IS NULL
           AND (u.password_hash <> '' OR EXISTS
                (SELECT 1 FROM identities n WHERE n.user_id = u.id))
         ORDER BY u.id LIMIT 1",
        operator
    )?;
    Ok(found.is_some())
}

/// Tells whether an operator has an admin who can sign in with a password.
pub(super) async fn has_admin(tx: &mut Tx, operator: OperatorId) -> db::Result<bool> {
    let found = row!(
        in tx,
        (i64,),
        "SELECT COUNT(*) FROM users
         WHERE operator_id = $1 AND role = 'admin' AND disabled_at IS NULL
           AND password_hash <> ''",
        operator
    )?;
    Ok(found.is_some_and(|(admins,)| admins > 0))
}

pub(super) async fn update(
    tx: &mut Tx,
    id: UserId,
    name: Option<&str>,
    role: Option<Role>,
) -> db::Result<()> {
    execute!(
        tx,
        "UPDATE users SET name = COALESCE($2, name), role = COALESCE($3, role) WHERE id = $1",
        id,
        name,
        role
    )
    .map(drop)
}

pub(super) async fn disable(tx: &mut Tx, id: UserId, now: Time) -> db::Result<()> {
    execute!(
        &mut *tx,
        "UPDATE users SET disabled_at = COALESCE(disabled_at, $2) WHERE id = $1",
        id,
        now
    )?;
    codes::delete_all(tx, id).await?;
    session::end_all(tx, id, None).await
}

pub(super) async fn enable(tx: &mut Tx, id: UserId) -> db::Result<()> {
    execute!(tx, "UPDATE users SET disabled_at = NULL WHERE id = $1", id).map(drop)
}

pub(super) async fn delete(tx: &mut Tx, operator: OperatorId, id: UserId) -> db::Result<bool> {
    outbox::forget(tx, id.0).await?;
    let deleted = execute!(
        tx,
        "DELETE FROM users WHERE operator_id = $1 AND id = $2",
        operator,
        id
    )?;
    Ok(deleted > 0)
}

pub(super) async fn rules(db: &Db, operator: OperatorId) -> Result<SignInRules> {
    let rules = row!(
        db,
        SignInRules,
        "SELECT second_factor_required FROM operators WHERE id = $1 ORDER BY id",
        operator
    )?;
    rules.ok_or(Error::NotFound("operator"))
}

pub(super) async fn set_rules(
    tx: &mut Tx,
    operator: OperatorId,
    rules: SignInRules,
) -> db::Result<()> {
    execute!(
        tx,
        "UPDATE operators SET second_factor_required = $2 WHERE id = $1",
        operator,
        rules.second_factor_required
    )
    .map(drop)
}

/// Counts the users of a tenant.
pub(super) fn count(tx: &mut Tx, tenant: Tenant, _: Time) -> BoxFuture<'_, db::Result<i64>> {
    Box::pin(async move {
        let found = row!(
            in tx,
            (i64,),
            "SELECT COUNT(*) FROM users WHERE operator_id = $1 OR firm_id = $2",
            tenant.operator(),
            tenant.firm()
        )?;
        Ok(found.map_or(0, |(count,)| count))
    })
}
