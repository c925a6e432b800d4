//! Queues in the database, one per receiver.
//!
//! Invariants: a receiver's deliveries are numbered in the order in which their transactions
//! commit. Of the messages about one thing only the first pending delivery is due, and likewise
//! of those about none. Only the worker that holds the lease sends it, and no other worker serves the same
//! receiver meanwhile. A transaction locks webhooks before mail recipients, each in the order
//! of their ids, so that no two transactions wait for each other.

use super::delivery::{Channel, DeliveryState, Message};
use crate::db::{Connection, Db, Result, Tx, execute, row, rows};
use crate::ids::DeliveryId;
use crate::time::Time;
use sha2::{Digest, Sha256};
use uuid::Uuid;

/// Lease of one attempt, seconds: longer than any attempt takes.
const LEASE_S: f64 = 90.0;
/// Maximum number of a tenant's receivers served at once, so that slow receivers do not delay
/// those of other tenants.
const MAX_OF_TENANT: i64 = 2;
const FIRST_RETRY_S: f64 = 10.0;
const LONGEST_RETRY_S: f64 = 3600.0;
/// Time after which an undelivered message is given up, seconds.
const GIVEN_UP_AFTER_S: f64 = 86_400.0;
/// Time after which a finished delivery is deleted, seconds.
const KEPT_FOR_S: f64 = 30.0 * 86_400.0;

/// Delivery that a worker has claimed.
#[derive(Clone, Debug, sqlx::FromRow)]
pub struct Claimed {
    /// Receiver of the message.
    pub receiver_id: Uuid,
    /// Number in the receiver's queue.
    pub number: i64,
    /// Id of the event.
    pub id: DeliveryId,
    /// Number of attempts, this one included; distinguishes this lease from later ones.
    pub attempts: i64,
    /// Creation time of the message.
    pub created_at: Time,
    /// Time at which it was last queued.
    pub tries_since: Time,
    /// Body of the message, JSON.
    pub body: String,
}

/// Queues a message for a receiver; does nothing if the receiver was removed meanwhile.
pub async fn queue(tx: &mut Tx, receiver: Uuid, message: &Message, now: Time) -> Result<()> {
    // Updating the receiver's row serialises the transactions until they commit.
    let number = row!(
        in &mut *tx,
        (i64,),
        "UPDATE receivers SET last_number = last_number + 1 WHERE id = $1 RETURNING last_number",
        receiver
    )?;
    let Some((number,)) = number else {
        return Ok(());
    };
    execute!(
        &mut *tx,
        "INSERT INTO deliveries (receiver_id, number, id, kind, body, state, created_at,
                                 tries_since, attempts, next_attempt_at, order_id)
         VALUES ($1, $2, $3, $4, $5, 'pending', $6, $6, 0, $6, $7)",
        receiver,
        number,
        message.id,
        message.kind.name(),
        message.body.as_str(),
        now,
        message.about
    )?;
    execute!(
        &mut *tx,
        "DELETE FROM deliveries
         WHERE receiver_id = $1 AND state <> 'pending' AND created_at < $2",
        receiver,
        Time(now.0.plus_seconds(-KEPT_FOR_S))
    )?;
    Ok(())
}

macro_rules! claim_sql {
    ($lock:literal) => {
        concat!(
            "WITH busy AS (
                 SELECT u.receiver_id, t.operator_id, t.firm_id FROM deliveries u
                 JOIN receivers t ON t.id = u.receiver_id AND t.channel = $3
                 WHERE u.state = 'pending' AND u.lease_until > $1)
             UPDATE deliveries SET attempts = attempts + 1, lease_until = $2
             WHERE (receiver_id, number) = (
                 SELECT d.receiver_id, d.number FROM deliveries d
                 JOIN receivers r ON r.id = d.receiver_id AND r.enabled AND r.channel = $3
                 WHERE d.state = 'pending' AND d.next_attempt_at <= $1
                   AND NOT EXISTS (
                       SELECT 1 FROM deliveries e
                       WHERE e.receiver_id = d.receiver_id AND e.state = 'pending'
                         AND e.order_id IS NOT DISTINCT FROM d.order_id
                         AND e.number < d.number)
                   AND NOT EXISTS (SELECT 1 FROM busy b WHERE b.receiver_id = d.receiver_id)
                   AND (SELECT COUNT(*) FROM busy b
                        WHERE b.operator_id = r.operator_id OR b.firm_id = r.firm_id) < $4
                 ORDER BY d.next_attempt_at, d.receiver_id
                 LIMIT 1",
            $lock,
            ") RETURNING receiver_id, number, id, attempts, created_at, tries_since, body"
        )
    };
}

/// Claims the delivery of a channel that has been due for longest.
pub(super) async fn claim(db: &Db, channel: Channel, now: Time) -> Result<Option<Claimed>> {
    // Reading first keeps an idle worker from taking SQLite's write lock.
    let due = rows!(
        db,
        (i64,),
        "WITH busy AS (
             SELECT u.receiver_id, t.operator_id, t.firm_id FROM deliveries u
             JOIN receivers t ON t.id = u.receiver_id AND t.channel = $2
             WHERE u.state = 'pending' AND u.lease_until > $1)
         SELECT d.number FROM deliveries d
         JOIN receivers r ON r.id = d.receiver_id AND r.enabled AND r.channel = $2
         WHERE d.state = 'pending' AND d.next_attempt_at <= $1
           AND NOT EXISTS (
               SELECT 1 FROM deliveries e
               WHERE e.receiver_id = d.receiver_id AND e.state = 'pending'
                 AND e.order_id IS NOT DISTINCT FROM d.order_id
                 AND e.number < d.number)
           AND NOT EXISTS (SELECT 1 FROM busy b WHERE b.receiver_id = d.receiver_id)
           AND (SELECT COUNT(*) FROM busy b
                WHERE b.operator_id = r.operator_id OR b.firm_id = r.firm_id) < $3
         ORDER BY d.next_attempt_at
         LIMIT 1",
        now,
        channel,
        MAX_OF_TENANT
    )?;
    if due.is_empty() {
        return Ok(None);
    }
    let lease_until = Time(now.0.plus_seconds(LEASE_S));
    let mut tx = db.begin().await?;
    let claimed = match tx.connection() {
        Connection::Sqlite(tx) => {
            sqlx::query_as(claim_sql!(""))
                .bind(now)
                .bind(lease_until)
                .bind(channel)
                .bind(MAX_OF_TENANT)
                .fetch_optional(&mut **tx)
                .await?
        }
        // Workers of other processes claim other receivers instead of waiting.
        Connection::Postgres(tx) => {
            sqlx::query_as(claim_sql!(" FOR UPDATE OF d SKIP LOCKED"))
                .bind(now)
                .bind(lease_until)
                .bind(channel)
                .bind(MAX_OF_TENANT)
                .fetch_optional(&mut **tx)
                .await?
        }
    };
    tx.commit().await?;
    Ok(claimed)
}

/// Notes that a delivery arrived.
pub(super) async fn succeed(db: &Db, claimed: &Claimed, status: u16, now: Time) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "UPDATE deliveries
         SET state = 'delivered', delivered_at = $4, lease_until = NULL, last_status = $5,
             last_error = NULL
         WHERE receiver_id = $1 AND number = $2 AND attempts = $3 AND state = 'pending'",
        claimed.receiver_id,
        claimed.number,
        claimed.attempts,
        now,
        i64::from(status)
    )?;
    tx.commit().await
}

/// Checks whether the retry period of a delivery is over.
pub(super) fn is_given_up(claimed: &Claimed, now: Time) -> bool {
    now.0.seconds_since(claimed.tries_since.0) >= GIVEN_UP_AFTER_S
}

/// Schedules the next attempt of a delivery, or gives it up.
pub(super) async fn fail(
    db: &Db,
    claimed: &Claimed,
    status: Option<u16>,
    error: &str,
    dead: bool,
    now: Time,
) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "UPDATE deliveries
         SET state = $4, next_attempt_at = $5, lease_until = NULL, last_status = $6,
             last_error = $7
         WHERE receiver_id = $1 AND number = $2 AND attempts = $3 AND state = 'pending'",
        claimed.receiver_id,
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
    tx.commit().await
}

/// Returns the seconds until the next attempt: exponential backoff up to an hour, plus up to a
/// quarter as jitter. The jitter follows from the delivery's id, so that a receiver that
/// returns does not get all retries at once.
fn retry_s(id: DeliveryId, attempts: i64) -> f64 {
    let doubled_s = FIRST_RETRY_S * 2_f64.powi(attempts.clamp(1, 20) as i32 - 1);
    let digest = Sha256::digest(format!("{id} {attempts}"));
    let share = f64::from(u16::from_be_bytes([digest[0], digest[1]])) / 65_536.0;
    doubled_s.min(LONGEST_RETRY_S) * (1.0 + 0.25 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn retries_back_off_with_jitter() {
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
