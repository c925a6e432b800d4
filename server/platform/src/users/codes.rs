//! One-time codes in the database: of invitations, and of people who forgot their password.
//!
//! Invariants: codes are stored as hashes. A user has at most one of each kind, so that a stranger
//! who asks for a reset does not replace an invitation.

use crate::db::{Db, Result, Tx, execute, row};
use crate::ids::{FirmId, OperatorId, UserId};
use crate::secret;
use crate::tenants::Tenant;
use crate::time::Time;

/// User of a code.
#[derive(sqlx::FromRow)]
pub(super) struct Invited {
    pub(super) user_id: UserId,
    pub(super) email: String,
    pub(super) name: String,
    operator_id: Option<OperatorId>,
    firm_id: Option<FirmId>,
    /// Name of the user's company.
    pub(super) company: Option<String>,
    pub(super) expires_at: Time,
}

impl Invited {
    pub(super) fn tenant(&self) -> Option<Tenant> {
        tenant(self.operator_id, self.firm_id)
    }
}

/// User who forgot the password.
pub(super) struct Forgetful {
    pub(super) user: UserId,
    pub(super) name: String,
    pub(super) tenant: Option<Tenant>,
}

fn tenant(operator: Option<OperatorId>, firm: Option<FirmId>) -> Option<Tenant> {
    let operator = operator.map(Tenant::Operator);
    operator.or(firm.map(Tenant::Firm))
}

/// Creates the code of an invitation, in place of all earlier codes of the user.
pub(super) async fn insert_invitation(
    tx: &mut Tx,
    user: UserId,
    now: Time,
    expires_at: Time,
) -> Result<String> {
    let code = secret::new_code();
    delete_all(tx, user).await?;
    execute!(
        tx,
        "INSERT INTO invitations (user_id, code_hash, created_at, expires_at)
         VALUES ($1, $2, $3, $4)",
        user,
        secret::hash(&secret::normal_code(&code)),
        now,
        expires_at
    )?;
    Ok(code)
}

/// Creates the code of a user who forgot the password; none if the user got one after
/// `last_before`. An invitation stays valid.
pub(super) async fn insert_reset(
    tx: &mut Tx,
    user: UserId,
    last_before: Time,
    now: Time,
    expires_at: Time,
) -> Result<Option<String>> {
    let code = secret::new_code();
    let inserted = execute!(
        tx,
        "INSERT INTO password_resets (user_id, code_hash, created_at, expires_at)
         VALUES ($1, $2, $3, $4)
         ON CONFLICT (user_id) DO UPDATE
         SET code_hash = excluded.code_hash, created_at = excluded.created_at,
             expires_at = excluded.expires_at
         WHERE password_resets.created_at <= $5",
        user,
        secret::hash(&secret::normal_code(&code)),
        now,
        expires_at,
        last_before
    )?;
    Ok((inserted > 0).then_some(code))
}

/// Finds the user of an address who may be sent a code: one who is not disabled and signs in by
/// password.
pub(super) async fn find_forgetful(db: &Db, email: &str) -> Result<Option<Forgetful>> {
    let found = row!(
        db,
        (UserId, String, Option<OperatorId>, Option<FirmId>),
        "SELECT u.id, u.name, u.operator_id, u.firm_id FROM users u
         WHERE u.email = $1 AND u.disabled_at IS NULL
           AND NOT EXISTS (SELECT 1 FROM identities n WHERE n.user_id = u.id)
         ORDER BY u.id",
        email
    )?;
    Ok(found.map(|(user, name, operator, firm)| Forgetful {
        user,
        name,
        tenant: tenant(operator, firm),
    }))
}

/// Finds the user of a code, if the user is not disabled.
pub(super) async fn find(db: &Db, code_hash: &[u8]) -> Result<Option<Invited>> {
    row!(
        db,
        Invited,
        "SELECT c.user_id, u.email, u.name, u.operator_id, u.firm_id,
                COALESCE(o.name, f.name) AS company, c.expires_at
         FROM (SELECT user_id, expires_at FROM invitations WHERE code_hash = $1
               UNION ALL
               SELECT user_id, expires_at FROM password_resets WHERE code_hash = $1) c
         JOIN users u ON u.id = c.user_id
         LEFT JOIN operators o ON o.id = u.operator_id
         LEFT JOIN firms f ON f.id = u.firm_id
         WHERE u.disabled_at IS NULL
         ORDER BY c.user_id",
        code_hash
    )
}

/// Uses a code up, and with it the user's other one; false where another request has used it.
pub(super) async fn use_up(tx: &mut Tx, user: UserId, code_hash: &[u8]) -> Result<bool> {
    let invitations = execute!(
        &mut *tx,
        "DELETE FROM invitations WHERE user_id = $1 AND code_hash = $2",
        user,
        code_hash
    )?;
    let resets = execute!(
        &mut *tx,
        "DELETE FROM password_resets WHERE user_id = $1 AND code_hash = $2",
        user,
        code_hash
    )?;
    delete_all(tx, user).await?;
    Ok(invitations + resets > 0)
}

/// Deletes the codes of a user.
pub(super) async fn delete_all(tx: &mut Tx, user: UserId) -> Result<()> {
    execute!(&mut *tx, "DELETE FROM invitations WHERE user_id = $1", user)?;
    execute!(tx, "DELETE FROM password_resets WHERE user_id = $1", user)?;
    Ok(())
}
