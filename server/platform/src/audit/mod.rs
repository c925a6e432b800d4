//! The audit log: who changed what, and what firms read of ships.
//!
//! What always holds:
//!
//! - A change that is in the database has its line there: the line is written in the
//!   transaction of the change. What a firm asks for of an order is not sent before its
//!   line is on disk. What is refused is noted too, after the answer is known, if it is
//!   known who asked.
//! - A line has no secret in it: no body, no query, no header; of a path only ids and
//!   numbers.
//! - A line is never changed but for the status of the answer, once, and goes only when
//!   it is as old as the setting says.
//!
//! Batches of samples are not in it: they are a log themselves.

mod csv;
mod middleware;
mod query;
mod request;
mod store;
mod trail;

pub use middleware::{leave_out, log_request};
pub use query::router;
pub use request::RequestContext;
pub use trail::{Actor, FindVessel};

use crate::app::App;
use crate::ids::{OrderId, TokenId, VesselId};
use crate::time::Time;
use serde::{Deserialize, Serialize};
use std::time::Duration;
use tracing::{error, info};
use utoipa::{IntoParams, ToSchema};
use uuid::Uuid;

/// How often to look for lines that are too old.
const FORGET_EVERY: Duration = Duration::from_hours(1);

/// Something that was done, or tried.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = AuditLine)]
struct Line {
    /// The request's id, as the answer's `X-Request-Id` gave it.
    id: Uuid,
    /// When.
    at: Time,
    /// Who.
    actor_kind: ActorKind,
    /// The user's or the agent's id.
    #[schema(required)]
    actor_id: Option<Uuid>,
    /// The name at that time; of an agent, its vessel's.
    actor_name: String,
    /// The API token that stood for the user.
    #[schema(required)]
    token_id: Option<TokenId>,
    /// The operator whose fleet it was about, or whose people did it.
    #[schema(required)]
    operator_id: Option<Uuid>,
    /// The firm whose people did it, or which it was about.
    #[schema(required)]
    firm_id: Option<Uuid>,
    /// Where from; empty if that is not known.
    address: String,
    /// What was done: the request's method. Empty for a command on the server itself.
    method: String,
    /// The route, as this document names it, or the command.
    route: String,
    /// The route with its ids.
    path: String,
    /// The vessel that it was about.
    #[schema(required)]
    vessel_id: Option<VesselId>,
    /// The work order that it was about.
    #[schema(required)]
    order_id: Option<OrderId>,
    /// The status of the answer. None if it was done and the server ended, or the client
    /// went, before there was one.
    #[schema(required)]
    status: Option<i64>,
}

/// Who did something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
enum ActorKind {
    /// A person who had signed in.
    User,
    /// A program with a person's API token.
    Token,
    /// A ship's agent.
    Agent,
    /// Someone at the server's own command line.
    Command,
}

/// Which lines.
#[derive(Clone, Debug, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Filter {
    /// Of this user or agent only.
    actor: Option<Uuid>,
    /// About this vessel only.
    vessel: Option<VesselId>,
    /// About this work order only.
    order: Option<OrderId>,
    /// Of this route only, like `/api/v1/work-orders/{id}/model`.
    route: Option<String>,
    /// The first instant, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    from: Option<String>,
    /// The instant after the last, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    to: Option<String>,
}

/// Removes the lines that are older than is kept, and says how many.
pub async fn forget(app: &App) -> crate::db::Result<u64> {
    let kept_s = f64::from(app.config.audit_days) * 86_400.0;
    let before = app.clock.now().plus_seconds(-kept_s);
    store::remove_before(&app.db, before.into()).await
}

/// Removes them until the server stops.
pub async fn watch(app: App) {
    while !app.stopping.is_cancelled() {
        match forget(&app).await {
            Ok(0) => {}
            Ok(lines) => info!(lines, "old lines of the audit log were removed"),
            Err(error) => error!(?error, "old lines of the audit log cannot be removed"),
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(FORGET_EVERY) => {}
        }
    }
}
