//! The deliveries of webhooks in the database: a queue for each webhook.
//!
//! What always holds: a webhook's deliveries are numbered in the order in which
//! their transactions commit, and only the first that waits is due. One worker at a
//! time has it, the one that holds its lease. Webhooks are always taken in the order
//! of their ids, so that no two transactions wait for each other.

use super::webhook::{Delivery, DeliveryState, Kind, Kinds};
use crate::db::{Db, Result as DbResult, Tx, execute, row, rows};
use crate::error::{Error, Result};
use crate::ids::{DeliveryId, OperatorId, WebhookId};
use crate::time::Time;
use serde_json::value::RawValue;
use sha2::{Digest, Sha256};

/// How long a try may take before another worker may try: longer than any request.
const LEASE_S: f64 = 30.0;
const FIRST_RETRY_S: f64 = 10.0;
const LONGEST_RETRY_S: f64 = 3600.0;
/// What could not be delivered for so long is given up.
const GIVEN_UP_AFTER_S: f64 = 86_400.0;
/// What was delivered or given up is forgotten after so long.
const KEPT_FOR_S: f64 = 30.0 * 86_400.0;

/// Something to be told.
#[derive(Clone, Debug)]
pub struct Message {
    /// The event's id.
    pub id: DeliveryId,
    /// What it tells of.
    pub kind: Kind,
    /// JSON.
    pub body: String,
}

/// A delivery that a worker has claimed.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(super) struct Claimed {
    pub(super) webhook_id: WebhookId,
    pub(super) number: i64,
    pub(super) id: DeliveryId,
    /// This one included; tells this lease from later ones.
    pub(super) attempts: i64,
    pub(super) tries_since: Time,
    pub(super) body: String,
    pub(super) url: String,
    pub(super) secret: String,
}

#[derive(sqlx::FromRow)]
struct Row {
    id: DeliveryId,
    kind: Kind,
    state: DeliveryState,
    created_at: Time,
    attempts: i64,
    next_attempt_at: Time,
    last_status: Option<i64>,
    last_error: Option<String>,
    delivered_at: Option<Time>,
    number: i64,
    body: String,
}

/// Queues messages for those of an operator's webhooks that want them.
pub async fn announce(
    tx: &mut Tx,
    operator: OperatorId,
    messages: &[Message],
    now: Time,
) -> Result<()> {
    let webhooks = rows!(
        in &mut *tx,
        (WebhookId, String),
        "SELECT id, kinds FROM webhooks WHERE operator_id = $1 AND enabled ORDER BY id",
        operator
    )?;
    for (webhook, kinds) in webhooks {
        let kinds = Kinds::try_from(kinds)?;
        let wanted = messages
            .iter()
            .filter(|message| kinds.0.contains(&message.kind));
        for message in wanted {
            queue(tx, webhook, message, now).await?;
        }
    }
    Ok(())
}

/// Queues a message for one webhook.
pub(super) async fn queue(
    tx: &mut Tx,
    webhook: WebhookId,
    message: &Message,
    now: Time,
) -> Result<()> {
    // Taking the webhook's row puts transactions in line until they commit.
    let number = row!(
        in &mut *tx,
        (i64,),
        "UPDATE webhooks SET last_number = last_number + 1 WHERE id = $1 RETURNING last_number",
        webhook
    )?;
    let Some((number,)) = number else {
        return Ok(()); // It was removed meanwhile.
    };
    execute!(
        &mut *tx,
        "INSERT INTO webhook_deliveries (webhook_id, number, id, kind, body, state, created_at,
                                         tries_since, attempts, next_attempt_at)
         VALUES ($1, $2, $3, $4, $5, 'pending', $6, $6, 0, $6)",
        webhook,
        number,
        message.id,
        message.kind,
        message.body.as_str(),
        now
    )?;
    execute!(
        &mut *tx,
        "DELETE FROM webhook_deliveries
         WHERE webhook_id = $1 AND state <> 'pending' AND created_at < $2",
        webhook,
        Time(now.0.plus_seconds(-KEPT_FOR_S))
    )?;
    Ok(())
}

macro_rules! claim_sql {
    ($lock:literal) => {
        concat!(
            "UPDATE webhook_deliveries SET attempts = attempts + 1, lease_until = $2
             WHERE (webhook_id, number) = (
                 SELECT d.webhook_id, d.number FROM webhook_deliveries d
                 JOIN webhooks w ON w.id = d.webhook_id AND w.enabled
                 WHERE d.state = 'pending' AND d.next_attempt_at <= $1
                   AND (d.lease_until IS NULL OR d.lease_until <= $1)
                   AND NOT EXISTS (
                       SELECT 1 FROM webhook_deliveries e
                       WHERE e.webhook_id = d.webhook_id AND e.state = 'pending'
                         AND e.number < d.number)
                 ORDER BY d.next_attempt_at, d.webhook_id
                 LIMIT 1",
            $lock,
            ")
             RETURNING webhook_id, number, id, attempts, tries_since, body,
                       (SELECT url FROM webhooks w WHERE w.id = webhook_id) AS url,
                       (SELECT secret FROM webhooks w WHERE w.id = webhook_id) AS secret"
        )
    };
}

/// Takes the delivery that has been due for longest.
pub(super) async fn claim(db: &Db, now: Time) -> DbResult<Option<Claimed>> {
    // Asking first keeps an idle worker from taking SQLite's write lock.
    let due = rows!(
        db,
        (i64,),
        "SELECT d.number FROM webhook_deliveries d
         JOIN webhooks w ON w.id = d.webhook_id AND w.enabled
         WHERE d.state = 'pending' AND d.next_attempt_at <= $1
           AND (d.lease_until IS NULL OR d.lease_until <= $1)
           AND NOT EXISTS (
               SELECT 1 FROM webhook_deliveries e
               WHERE e.webhook_id = d.webhook_id AND e.state = 'pending'
                 AND e.number < d.number)
         ORDER BY d.next_attempt_at
         LIMIT 1",
        now
    )?;
    if due.is_empty() {
        return Ok(None);
    }
    let lease_until = Time(now.0.plus_seconds(LEASE_S));
    let mut tx = db.begin().await?;
    let claimed = match &mut tx {
        Tx::Sqlite(tx) => {
            sqlx::query_as(claim_sql!(""))
                .bind(now)
                .bind(lease_until)
                .fetch_optional(&mut **tx)
                .await?
        }
        // Workers of other processes take other webhooks rather than wait.
        Tx::Postgres(tx) => {
            sqlx::query_as(claim_sql!(" FOR UPDATE OF d SKIP LOCKED"))
                .bind(now)
                .bind(lease_until)
                .fetch_optional(&mut **tx)
                .await?
        }
    };
    tx.commit().await?;
    Ok(claimed)
}

/// Notes that a delivery arrived.
pub(super) async fn succeed(db: &Db, claimed: &Claimed, status: u16, now: Time) -> DbResult<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "UPDATE webhook_deliveries
         SET state = 'delivered', delivered_at = $4, lease_until = NULL, last_status = $5,
             last_error = NULL
         WHERE webhook_id = $1 AND number = $2 AND attempts = $3 AND state = 'pending'",
        claimed.webhook_id,
        claimed.number,
        claimed.attempts,
        now,
        i64::from(status)
    )?;
    tx.commit().await
}

/// Puts a delivery back for later, or gives it up; says whether it was given up.
pub(super) async fn fail(
    db: &Db,
    claimed: &Claimed,
    status: Option<u16>,
    error: &str,
    now: Time,
) -> DbResult<bool> {
    let dead = now.0.seconds_since(claimed.tries_since.0) >= GIVEN_UP_AFTER_S;
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "UPDATE webhook_deliveries
         SET state = $4, next_attempt_at = $5, lease_until = NULL, last_status = $6,
             last_error = $7
         WHERE webhook_id = $1 AND number = $2 AND attempts = $3 AND state = 'pending'",
        claimed.webhook_id,
        claimed.number,
        claimed.attempts,
        if dead {
            DeliveryState::Dead
        } else {
            DeliveryState::Pending
        },
        Time(now.0.plus_seconds(retry_s(claimed.id, claimed.attempts))),
        status.map(i64::from),
        error
    )?;
    tx.commit().await?;
    Ok(dead)
}

/// Seconds until the next try: twice as long each time, up to an hour, and within a
/// quarter more that the delivery's id decides, so that receivers that were away
/// are not called upon by everyone at once.
pub(super) fn retry_s(id: DeliveryId, attempts: i64) -> f64 {
    let doubled_s = FIRST_RETRY_S * 2_f64.powi(attempts.clamp(1, 20) as i32 - 1);
    let digest = Sha256::digest(format!("{id} {attempts}"));
    let share = f64::from(u16::from_be_bytes([digest[0], digest[1]])) / 65_536.0;
    doubled_s.min(LONGEST_RETRY_S) * (1.0 + 0.25 * share)
}

/// The newest first, from before a number, with their numbers.
pub(super) async fn list(
    db: &Db,
    webhook: WebhookId,
    state: Option<DeliveryState>,
    before: Option<i64>,
    limit: i64,
) -> Result<Vec<(i64, Delivery)>> {
    let found = rows!(
        db,
        Row,
        "SELECT id, kind, state, created_at, attempts, next_attempt_at, last_status, last_error,
                delivered_at, number, body
         FROM webhook_deliveries
         WHERE webhook_id = $1 AND number < $2 AND ($3 IS NULL OR state = $3)
         ORDER BY number DESC
         LIMIT $4",
        webhook,
        before.unwrap_or(i64::MAX),
        state,
        limit
    )?;
    found.into_iter().map(Row::read).collect()
}

/// A webhook's delivery.
///
/// # Errors
/// [`Error::NotFound`] when it has none of that id.
pub(super) async fn must_find(db: &Db, webhook: WebhookId, id: DeliveryId) -> Result<Delivery> {
    let found = row!(
        db,
        Row,
        "SELECT id, kind, state, created_at, attempts, next_attempt_at, last_status, last_error,
                delivered_at, number, body
         FROM webhook_deliveries
         WHERE webhook_id = $1 AND id = $2
         ORDER BY number",
        webhook,
        id
    )?;
    let (_, delivery) = found.ok_or(Error::NotFound("delivery"))?.read()?;
    Ok(delivery)
}

/// Has a delivery tried again at once, and for another day; one that waits too.
///
/// # Errors
/// [`Error::NotFound`] when the webhook has none of that id.
pub(super) async fn send_again(
    tx: &mut Tx,
    webhook: WebhookId,
    id: DeliveryId,
    now: Time,
) -> Result<()> {
    let changed = execute!(
        tx,
        "UPDATE webhook_deliveries
         SET state = 'pending', attempts = 0, tries_since = $3, next_attempt_at = $3,
             lease_until = NULL, delivered_at = NULL
         WHERE webhook_id = $1 AND id = $2",
        webhook,
        id,
        now
    )?;
    if changed == 0 {
        return Err(Error::NotFound("delivery"));
    }
    Ok(())
}

impl Row {
    fn read(self) -> Result<(i64, Delivery)> {
        let waits = self.state == DeliveryState::Pending;
        let delivery = Delivery {
            id: self.id,
            kind: self.kind,
            state: self.state,
            created_at: self.created_at,
            attempts: self.attempts,
            next_attempt_at: Some(self.next_attempt_at).filter(|_| waits),
            last_status: self.last_status,
            last_error: self.last_error,
            delivered_at: self.delivered_at,
            body: RawValue::from_string(self.body)?,
        };
        Ok((self.number, delivery))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tries_come_ever_more_seldom_and_not_all_at_once() {
        let (one, other) = (DeliveryId::new(), DeliveryId::new());
        for attempts in 1..40 {
            let least_s = (10.0 * 2_f64.powi(attempts - 1)).min(3600.0);
            let wait_s = retry_s(one, i64::from(attempts));
            assert!(
                (least_s..1.25 * least_s).contains(&wait_s),
                "{attempts}: {wait_s}"
            );
        }
        assert_ne!(retry_s(one, 3).to_bits(), retry_s(other, 3).to_bits());
        assert_eq!(retry_s(one, 3).to_bits(), retry_s(one, 3).to_bits());
    }
}
