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
    let difference = page.status.borrow().heading_difference.clone();
    let difference = difference.filter(|difference| difference.alarm.id == seen.id);
    let is_new = match difference {
        Some(difference) => !difference.alarm.acknowledged,
        None => save_acknowledgement(&page.spool, seen.id).await?,
    };
    if is_new {
        let action = "acknowledgement of the alert";
        visitor.record(&page, action, "done").await;
        page.acknowledged.send_replace(Some(seen.id));
    }
    Ok(Json(seen))
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
