//! Audit log: changes by anyone, data of operators read by firms, and refused sign-ins.
//!
//! Invariants:
//!
//! - Every change in the database has a line, written in the transaction of the change.
//!   Such data is sent to a firm only after its line is on disk. A refused request is
//!   logged too, after the response is known, if the caller is known.
//! - A line contains no secret: no body, no query, no header, and of a path only ids and
//!   numbers.
//! - Only the response status of a line changes, once. A line is removed only when it is
//!   older than the retention setting.
//!
//! Batches of samples are excluded: they are a log themselves.

mod middleware;
mod refusal;
mod request;
mod store;
mod trail;

pub use middleware::{leave_out, log_request};
pub use refusal::Refusal;
pub use request::RequestContext;
pub(crate) use store::{Selection, list};
pub use trail::{Actor, FindVessel};

use crate::app::App;
use crate::ids::{OrderId, TokenId, VesselId};
use crate::time::Time;
use serde::{Deserialize, Serialize};
use std::time::Duration;
use tracing::{error, info};
use utoipa::{IntoParams, ToSchema};
use uuid::Uuid;

/// Interval between removals of expired lines.
const PRUNE_EVERY: Duration = Duration::from_hours(1);

/// Action that was done or tried.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = AuditLine)]
pub(crate) struct Line {
    /// Request id, as returned in `X-Request-Id`.
    pub(crate) id: Uuid,
    /// Time of the request.
    at: Time,
    /// Kind of actor.
    actor_kind: ActorKind,
    /// Id of the user or the agent.
    #[schema(required)]
    actor_id: Option<Uuid>,
    /// Name of the actor at that time; for an agent, its vessel's name.
    actor_name: String,
    /// API token that acted for the user.
    #[schema(required)]
    token_id: Option<TokenId>,
    /// Operator of the fleet concerned, or of the actor.
    #[schema(required)]
    operator_id: Option<Uuid>,
    /// Firm of the actor, or the firm concerned.
    #[schema(required)]
    firm_id: Option<Uuid>,
    /// Client address; empty if unknown.
    address: String,
    /// HTTP method of the request; empty for a command on the server itself.
    method: String,
    /// Route as named in this document, or the command.
    route: String,
    /// Route with its ids filled in.
    path: String,
    /// Vessel concerned.
    #[schema(required)]
    vessel_id: Option<VesselId>,
    /// Work order concerned.
    #[schema(required)]
    order_id: Option<OrderId>,
    /// Response status. Null if the action was done but the server stopped, or the client
    /// disconnected, before it responded.
    #[schema(required)]
    status: Option<i64>,
    /// E-mail address that was tried, of a refused sign-in.
    #[schema(required)]
    account: Option<String>,
    /// Reason for which a sign-in, a code or a token was refused.
    #[schema(required)]
    refusal: Option<Refusal>,
}

/// Kind of actor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub(crate) enum ActorKind {
    /// Person who had signed in.
    User,
    /// Program with a person's API token.
    Token,
    /// Vessel's agent.
    Agent,
    /// Person at the server's own command line.
    Command,
    /// Somebody who did not prove who they are.
    Unidentified,
}

/// Filter of audit lines.
#[derive(Clone, Debug, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(crate) struct Filter {
    /// Id of a user or an agent.
    pub(crate) actor: Option<Uuid>,
    /// Id of a vessel.
    pub(crate) vessel: Option<VesselId>,
    /// Id of a work order.
    pub(crate) order: Option<OrderId>,
    /// Route, like `/api/v1/work-orders/{id}/model`.
    pub(crate) route: Option<String>,
    /// Id of an API token.
    pub(crate) token: Option<TokenId>,
    /// `true` for refused sign-ins, codes and tokens alone.
    pub(crate) refused: Option<bool>,
    /// First instant, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    pub(crate) from: Option<String>,
    /// Instant after the last, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    pub(crate) to: Option<String>,
}

/// Removes expired lines and returns their number.
pub async fn forget(app: &App) -> crate::db::Result<u64> {
    let kept_s = f64::from(app.config.audit_days) * 86_400.0;
    let before = app.clock.now().plus_seconds(-kept_s);
    store::remove_before(&app.db, before.into()).await
}

/// Removes expired lines periodically until the server stops.
pub async fn watch(app: App) {
    while !app.stopping.is_cancelled() {
        match forget(&app).await {
            Ok(0) => {}
            Ok(lines) => info!(lines, "old lines of the audit log were removed"),
            Err(error) => error!(?error, "old lines of the audit log cannot be removed"),
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(PRUNE_EVERY) => {}
        }
    }
}
