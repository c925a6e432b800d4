//! Acknowledgement of an open alert.
//!
//! It needs no PIN: an officer must be able to silence an alert at once, and it changes neither the
//! heading nor what is sent ashore.

use super::author::Visitor;
use super::request_guard::Refusal;
use super::state::PageState;
use crate::alert::AlertRecord;
use crate::spool::Spool;
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// Alert to acknowledge.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Acknowledgement {
    id: Uuid,
}

/// Acknowledges an alert.
pub(super) async fn acknowledge(
    State(page): State<PageState>,
    visitor: Visitor,
    Json(seen): Json<Acknowledgement>,
) -> Result<Json<Acknowledgement>, Refusal> {
    let is_acknowledged = acknowledged_on_board(&page, seen.id);
    let is_new = match is_acknowledged {
        Some(is_acknowledged) => !is_acknowledged,
        None => save_acknowledgement(&page.spool, seen.id).await?,
    };
    if is_new {
        let action = "acknowledgement of the alert";
        visitor.record(&page, action, "done").await;
        page.acknowledged.send_replace(Some(seen.id));
    }
    Ok(Json(seen))
}

/// Returns whether an alert was acknowledged that only matters on board; `None` for another one.
fn acknowledged_on_board(page: &PageState, id: Uuid) -> Option<bool> {
    let status = page.status.borrow();
    let difference = status.heading_difference.as_ref();
    let difference = difference.map(|difference| &difference.alarm);
    let interference = status.gnss_interference.as_ref();
    let interference = interference.map(|interference| &interference.alert);
    let of_both = [
        difference.map(|alarm| (alarm.id, alarm.acknowledged)),
        interference.map(|alert| (alert.id, alert.acknowledged)),
    ];
    let mut of_both = of_both.into_iter().flatten();
    of_both
        .find(|(known, _)| *known == id)
        .map(|(_, acknowledged)| acknowledged)
}

/// Stores the acknowledgement of the last alert. Returns whether there was none before.
async fn save_acknowledgement(spool: &Spool, id: Uuid) -> Result<bool, Refusal> {
    let failed = |error| {
        tracing::error!(%error, "an acknowledgement cannot be stored");
        let why = "the acknowledgement cannot be stored".to_owned();
        (StatusCode::INTERNAL_SERVER_ERROR, why)
    };
    let known = spool.alert().await.map_err(failed)?;
    let Some(record) = known.filter(|known| known.alert.id == id) else {
        let why = "this alert no longer exists".to_owned();
        return Err((StatusCode::NOT_FOUND, why));
    };
    if record.acknowledged {
        return Ok(false);
    }
    let seen = AlertRecord {
        acknowledged: true,
        ..record
    };
    spool.save_alert(&seen).await.map_err(failed)?;
    Ok(true)
}
