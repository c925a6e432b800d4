//! Mail recipients in the database.

use super::recipient::{NewRecipient, Recipient};
use crate::db::{Db, Result as DbResult, Tx, execute, row, rows};
use crate::error::{Error, Result};
use crate::ids::{OperatorId, RecipientId};
use crate::outbox::{self, Channel};
use crate::severity::Severity;
use crate::time::Time;
use uuid::Uuid;

pub(super) async fn list(
    db: &Db,
    operator: OperatorId,
    after: Option<Uuid>,
    limit: i64,
) -> DbResult<Vec<Recipient>> {
    rows!(
        db,
        Recipient,
        "SELECT m.id, m.address, m.severity, m.created_at,
                (SELECT COUNT(*) FROM deliveries d
                 WHERE d.receiver_id = m.id AND d.state = 'pending') AS pending,
                (SELECT COUNT(*) FROM deliveries d
                 WHERE d.receiver_id = m.id AND d.state = 'dead') AS dead
         FROM mail_recipients m
         WHERE m.operator_id = $1 AND m.id > $2
         ORDER BY m.id
         LIMIT $3",
        operator,
        after.unwrap_or_default(),
        limit
    )
}

/// Returns a mail recipient of the operator.
///
/// # Errors
/// [`Error::NotFound`] when there is no such recipient.
pub(super) async fn must_find(db: &Db, operator: OperatorId, id: RecipientId) -> Result<Recipient> {
    row!(
        db,
        Recipient,
        "SELECT m.id, m.address, m.severity, m.created_at,
                (SELECT COUNT(*) FROM deliveries d
                 WHERE d.receiver_id = m.id AND d.state = 'pending') AS pending,
                (SELECT COUNT(*) FROM deliveries d
                 WHERE d.receiver_id = m.id AND d.state = 'dead') AS dead
         FROM mail_recipients m
         WHERE m.operator_id = $1 AND m.id = $2
         ORDER BY m.id",
        operator,
        id
    )?
    .ok_or(Error::NotFound("mail recipient"))
}

/// # Errors
/// Fails when the address is on the operator's list.
pub(super) async fn insert(
    tx: &mut Tx,
    operator: OperatorId,
    id: RecipientId,
    new: &NewRecipient,
    now: Time,
) -> Result<()> {
    outbox::insert(tx, operator, id.0, Channel::Mail, true).await?;
    let inserted = execute!(
        tx,
        "INSERT INTO mail_recipients (id, operator_id, address, severity, created_at)
         VALUES ($1, $2, $3, $4, $5)
         ON CONFLICT (operator_id, address) DO NOTHING",
        id,
        operator,
        new.address.as_str(),
        new.severity,
        now
    )?;
    if inserted == 0 {
        return Err(Error::Invalid {
            field: "address",
            detail: "is already on the list".to_owned(),
        });
    }
    Ok(())
}

/// # Errors
/// [`Error::NotFound`] when the operator has no such recipient.
pub(super) async fn change(
    tx: &mut Tx,
    operator: OperatorId,
    id: RecipientId,
    severity: Severity,
) -> Result<()> {
    let changed = execute!(
        tx,
        "UPDATE mail_recipients SET severity = $3 WHERE operator_id = $1 AND id = $2",
        operator,
        id,
        severity
    )?;
    if changed == 0 {
        return Err(Error::NotFound("mail recipient"));
    }
    Ok(())
}

/// Returns the address and the minimum severity of a mail recipient.
pub(super) async fn find_listed(db: &Db, id: Uuid) -> DbResult<Option<(String, Severity)>> {
    row!(
        db,
        (String, Severity),
        "SELECT address, severity FROM mail_recipients WHERE id = $1 ORDER BY id",
        id
    )
}

/// Returns the address of a user who may sign in.
pub(super) async fn find_person(db: &Db, id: Uuid) -> DbResult<Option<String>> {
    let person = row!(
        db,
        (String,),
        "SELECT email FROM users WHERE id = $1 AND disabled_at IS NULL ORDER BY id",
        id
    )?;
    Ok(person.map(|(email,)| email))
}

/// Returns an operator's mail recipients, each with its minimum severity.
pub(super) async fn list_recipients(
    tx: &mut Tx,
    operator: OperatorId,
) -> DbResult<Vec<(RecipientId, Severity)>> {
    rows!(
        in tx,
        (RecipientId, Severity),
        "SELECT id, severity FROM mail_recipients WHERE operator_id = $1 ORDER BY id",
        operator
    )
}

/// Returns the worst severity of a topic that was sent to a recipient.
pub(super) async fn last_severity(
    tx: &mut Tx,
    recipient: RecipientId,
    topic: Uuid,
) -> DbResult<Option<Severity>> {
    let found = row!(
        in tx,
        (Severity,),
        "SELECT severity FROM mail_told WHERE recipient_id = $1 AND alert_id = $2
         ORDER BY alert_id",
        recipient,
        topic
    )?;
    Ok(found.map(|(severity,)| severity))
}

/// Notes the severity of a topic that is sent to a recipient.
pub(super) async fn note_severity(
    tx: &mut Tx,
    recipient: RecipientId,
    topic: Uuid,
    severity: Severity,
) -> DbResult<()> {
    execute!(
        tx,
        "INSERT INTO mail_told (recipient_id, alert_id, severity) VALUES ($1, $2, $3)
         ON CONFLICT (recipient_id, alert_id) DO UPDATE SET severity = excluded.severity",
        recipient,
        topic,
        severity
    )?;
    Ok(())
}

/// Forgets a topic that has ended for the recipient.
pub(super) async fn forget(tx: &mut Tx, recipient: RecipientId, topic: Uuid) -> DbResult<()> {
    execute!(
        tx,
        "DELETE FROM mail_told WHERE recipient_id = $1 AND alert_id = $2",
        recipient,
        topic
    )?;
    Ok(())
}
