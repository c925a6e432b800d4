//! Hold buttons of the page.

use super::author::Author;
use super::request_guard::Refusal;
use super::state::PageState;
use crate::sampler::Exclusion;
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};

/// Request of a hold button; `null` ends the hold.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ExclusionRequest {
    /// New exclusion.
    #[serde(rename = "hold")]
    exclusion: Option<Exclusion>,
}

/// Stores an exclusion and puts it in effect.
pub(super) async fn set_exclusion(
    State(page): State<PageState>,
    author: Author,
    Json(request): Json<ExclusionRequest>,
) -> Result<Json<ExclusionRequest>, Refusal> {
    let action = Exclusion::action(request.exclusion);
    let stored = page.spool.set_exclusion(request.exclusion).await;
    let stored = stored.map_err(|error| {
        tracing::error!(%error, "a hold cannot be stored");
        let why = "the hold cannot be stored".to_owned();
        (StatusCode::INTERNAL_SERVER_ERROR, why)
    });
    author.record(&page, &action, stored).await?;
    page.exclusion.send_replace(request.exclusion);
    Ok(Json(request))
}
