//! History of a receiver's messages.

use super::delivery::{Delivery, DeliveryList, DeliveryState, Filter, Message};
use super::queue::queue;
use crate::audit::RequestContext;
use crate::db::{Db, execute, row, rows};
use crate::error::{Error, Result};
use crate::http::Page;
use crate::ids::DeliveryId;
use crate::time::Time;
use serde_json::value::RawValue;
use uuid::Uuid;

#[derive(sqlx::FromRow)]
struct Row {
    id: DeliveryId,
    kind: String,
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

/// Returns a page of a receiver's deliveries, newest first.
pub async fn list(db: &Db, receiver: Uuid, filter: Filter, page: &Page) -> Result<DeliveryList> {
    let found = rows!(
        db,
        Row,
        "SELECT id, kind, state, created_at, attempts, next_attempt_at, last_status, last_error,
                delivered_at, number, body
         FROM deliveries
         WHERE receiver_id = $1 AND number < $2 AND ($3 IS NULL OR state = $3)
         ORDER BY number DESC
         LIMIT $4",
        receiver,
        page.after_number()?.unwrap_or(i64::MAX),
        filter.state,
        page.fetch()
    )?;
    let listed = page.cut(found, |row| row.number.to_string());
    let items: Result<Vec<Delivery>> = listed.items.into_iter().map(Row::read).collect();
    Ok(DeliveryList {
        items: items?,
        next: listed.next,
    })
}

/// Returns a delivery of a receiver.
///
/// # Errors
/// [`Error::NotFound`] when it has none with that id.
async fn must_find(db: &Db, receiver: Uuid, id: DeliveryId) -> Result<Delivery> {
    let found = row!(
        db,
        Row,
        "SELECT id, kind, state, created_at, attempts, next_attempt_at, last_status, last_error,
                delivered_at, number, body
         FROM deliveries
         WHERE receiver_id = $1 AND id = $2
         ORDER BY number",
        receiver,
        id
    )?;
    found.ok_or(Error::NotFound("delivery"))?.read()
}

/// Queues a single message and returns its delivery.
///
/// # Errors
/// [`Error::NotFound`] when the receiver was removed meanwhile.
pub async fn queue_one(
    request: &RequestContext,
    receiver: Uuid,
    message: &Message,
    now: Time,
) -> Result<Delivery> {
    let mut tx = request.begin().await?;
    queue(&mut tx, receiver, message, now).await?;
    tx.commit().await?;
    must_find(request.db(), receiver, message.id).await
}

/// Queues a delivery again, pending or not: it is tried at once, and for another day.
///
/// # Errors
/// [`Error::NotFound`] when the receiver has none with that id.
pub async fn send_again(
    request: &RequestContext,
    receiver: Uuid,
    id: DeliveryId,
    now: Time,
) -> Result<Delivery> {
    let mut tx = request.begin().await?;
    let changed = execute!(
        &mut tx,
        "UPDATE deliveries
         SET state = 'pending', attempts = 0, tries_since = $3, next_attempt_at = $3,
             lease_until = NULL, delivered_at = NULL
         WHERE receiver_id = $1 AND id = $2",
        receiver,
        id,
        now
    )?;
    if changed == 0 {
        return Err(Error::NotFound("delivery"));
    }
    tx.commit().await?;
    must_find(request.db(), receiver, id).await
}

impl Row {
    fn read(self) -> Result<Delivery> {
        let waits = self.state == DeliveryState::Pending;
        Ok(Delivery {
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
        })
    }
}
