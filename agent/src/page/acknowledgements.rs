//! Acknowledgement of an open alert.

use super::request_guard::require_guard_header;
use super::state::PageState;
use crate::alert::AlertRecord;
use crate::spool::Spool;
use axum::Json;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
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
    headers: HeaderMap,
    Json(seen): Json<Acknowledgement>,
) -> Response {
    if let Err(refusal) = require_guard_header(&headers) {
        return refusal.into_response();
    }
    let difference = page.status.borrow().heading_difference.clone();
    if difference.is_some_and(|difference| difference.alarm.id == seen.id) {
        page.acknowledged.send_replace(Some(seen.id));
        return Json(seen).into_response();
    }
    match save_acknowledgement(&page.spool, seen.id).await {
        Ok(true) => {
            page.acknowledged.send_replace(Some(seen.id));
            Json(seen).into_response()
        }
        Ok(false) => (StatusCode::NOT_FOUND, "this alert no longer exists").into_response(),
        Err(error) => {
            tracing::error!(%error, "an acknowledgement cannot be stored");
            let why = "the acknowledgement cannot be stored";
            (StatusCode::INTERNAL_SERVER_ERROR, why).into_response()
        }
    }
}

/// Stores the acknowledgement of an alert, if it is the last one. Returns whether it is.
async fn save_acknowledgement(spool: &Spool, id: Uuid) -> sqlx::Result<bool> {
    let Some(record) = spool.alert().await?.filter(|known| known.alert.id == id) else {
        return Ok(false);
    };
    let seen = AlertRecord {
        acknowledged: true,
        ..record
    };
    spool.save_alert(&seen).await?;
    Ok(true)
}
