//! Hold buttons of the page.

use super::request_guard::require_guard_header;
use super::state::PageState;
use crate::sampler::Exclusion;
use axum::Json;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};

/// Request of a hold button; `null` ends the hold.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ExclusionRequest {
    /// New exclusion.
    #[serde(rename = "hold")]
    pub(crate) exclusion: Option<Exclusion>,
}

/// Stores an exclusion and puts it in effect.
pub(super) async fn set_exclusion(
    State(page): State<PageState>,
    headers: HeaderMap,
    Json(request): Json<ExclusionRequest>,
) -> Response {
    if let Err(refusal) = require_guard_header(&headers) {
        return refusal.into_response();
    }
    if let Err(error) = page.spool.set_exclusion(request.exclusion).await {
        tracing::error!(%error, "a hold cannot be stored");
        return (
            StatusCode::INTERNAL_SERVER_ERROR,
            "the hold cannot be stored",
        )
            .into_response();
    }
    page.exclusion.send_replace(request.exclusion);
    Json(request).into_response()
}
