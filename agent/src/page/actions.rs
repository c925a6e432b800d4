//! Record of the changes on board, and the right to make them.

use super::request_guard::Refusal;
use super::state::PageState;
use crate::spool::BoardAction;
use axum::Json;
use axum::extract::{ConnectInfo, State};
use axum::http::StatusCode;
use serde::Serialize;
use std::net::SocketAddr;

/// Number of actions that the page lists.
const LISTED: u32 = 50;

/// Right of the browser that asks.
#[derive(Debug, Serialize)]
pub(super) struct Access {
    /// Set if changes need a PIN.
    pin: bool,
    /// Set if this browser may send changes at all.
    allowed: bool,
}

/// Says who may alter something.
pub(super) async fn show_access(
    State(page): State<PageState>,
    ConnectInfo(peer): ConnectInfo<SocketAddr>,
) -> Json<Access> {
    Json(Access {
        pin: page.guard.has_pin(),
        allowed: page.guard.is_open_to(peer.ip()),
    })
}

/// Lists the last actions, the latest first.
pub(super) async fn list_actions(
    State(page): State<PageState>,
) -> Result<Json<Vec<BoardAction>>, Refusal> {
    page.spool.actions(LISTED).await.map(Json).map_err(|error| {
        tracing::error!(%error, "the actions cannot be read");
        let why = "the actions cannot be read".to_owned();
        (StatusCode::INTERNAL_SERVER_ERROR, why)
    })
}
