//! What is known of a request while it is served, until it is a line.

use super::{ActorKind, Line, store};
use crate::access::Caller;
use crate::app::App;
use crate::db::{self, Tx};
use crate::enrolment::Agent;
use crate::error::Error;
use crate::ids::{OrderId, UserId, VesselId};
use crate::oidc;
use crate::peer::Origin;
use crate::session::User;
use crate::tenants::Tenant;
use crate::time::Time;
use axum::extract::{FromRequestParts, MatchedPath, RawPathParams, Request, State};
use axum::http::{HeaderValue, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tracing::{Instrument, error, info_span};
use uuid::Uuid;

/// The header that names a request.
const REQUEST_ID: &str = "x-request-id";
/// What ships send is a log of its own.
const BATCHES: &str = "/api/v1/streams/{stream}/batches/{seq}";
/// What firms read of ships they read of an order.
const ORDERS: &str = "/api/v1/work-orders/{id}";

tokio::task_local! {
    static TRAIL: Arc<Trail>;
}

/// Who does something.
#[derive(Clone, Debug)]
pub struct Actor {
    kind: ActorKind,
    id: Option<Uuid>,
    name: String,
    token: Option<crate::ids::TokenId>,
    tenant: Option<Tenant>,
    vessel: Option<VesselId>,
}

impl Actor {
    /// A person, by id and name.
    pub fn person(id: UserId, name: &str, tenant: Option<Tenant>) -> Actor {
        Actor {
            kind: ActorKind::User,
            id: Some(id.0),
            name: name.to_owned(),
            token: None,
            tenant,
            vessel: None,
        }
    }

    /// A person who signs in.
    pub fn user(user: &User) -> Actor {
        Actor::person(user.user_id, &user.name, user.tenant())
    }
}

impl From<&Caller> for Actor {
    fn from(caller: &Caller) -> Actor {
        let kind = match caller.token {
            Some(_) => ActorKind::Token,
            None => ActorKind::User,
        };
        Actor {
            kind,
            token: caller.token,
            ..Actor::user(&caller.user)
        }
    }
}

impl From<&Agent> for Actor {
    fn from(agent: &Agent) -> Actor {
        Actor {
            kind: ActorKind::Agent,
            id: Some(agent.agent_id.0),
            name: String::new(),
            token: None,
            tenant: None,
            vessel: Some(agent.vessel_id),
        }
    }
}

/// Says who asks, as soon as that is known.
pub fn acts(actor: impl Into<Actor>) {
    let actor = actor.into();
    let _ = TRAIL.try_with(|trail| trail.known().actor = Some(actor));
}

/// Says whom it concerns, where the path does not.
pub fn concerns(tenant: Tenant) {
    let _ = TRAIL.try_with(|trail| trail.known().concerns = Some(tenant));
}

/// Says which vessel, and which order of hers, it concerns, where the path does not.
pub fn concerns_vessel(vessel: VesselId, order: Option<OrderId>) {
    let _ = TRAIL.try_with(|trail| {
        let mut known = trail.known();
        known.vessel = Some(vessel);
        known.order = order;
    });
}

/// Writes the line of the request that is being served, if it is a change by someone who is
/// known and has none yet; to be followed by [`kept`] once that is committed.
pub async fn write_with(tx: &mut Tx) -> db::Result<bool> {
    let Ok(trail) = TRAIL.try_with(Arc::clone) else {
        return Ok(false);
    };
    if !trail.is_change || trail.known().kept {
        return Ok(false);
    }
    trail.write(tx, None).await
}

/// Notes that what [`write_with`] wrote is on disk.
pub fn kept() {
    let _ = TRAIL.try_with(|trail| trail.known().kept = true);
}

/// Does the work of a command, with a line for what it changes.
pub async fn by_command<T>(command: &str, now: Time, work: impl Future<Output = T>) -> T {
    let actor = Actor {
        kind: ActorKind::Command,
        id: None,
        name: "command line".to_owned(),
        token: None,
        tenant: None,
        vessel: None,
    };
    let known = Known {
        actor: Some(actor),
        ..Known::default()
    };
    let trail = Trail {
        id: Uuid::now_v7(),
        at: now,
        address: String::new(),
        method: String::new(),
        route: command.to_owned(),
        path: command.to_owned(),
        is_change: true,
        known: Mutex::new(known),
    };
    TRAIL.scope(Arc::new(trail), work).await
}

/// Serves a request, and sees to it that what is to be noted of it is.
pub async fn keep(State(app): State<App>, request: Request, next: Next) -> Response {
    let (mut parts, body) = request.into_parts();
    let route = parts.extensions.get::<MatchedPath>();
    let route = route.map_or("", MatchedPath::as_str).to_owned();
    let from = Origin::of_request(&parts, &app);
    let is_ours = route.starts_with("/api/v1/") && route != BATCHES;
    let trail = Arc::new(Trail {
        id: Uuid::now_v7(),
        at: app.clock.now().into(),
        address: from.address_text(),
        method: parts.method.as_str().to_owned(),
        path: filled(&route, &mut parts).await,
        // Whoever comes back from the provider signs in.
        is_change: is_ours && (!parts.method.is_safe() || route == oidc::CALLBACK),
        known: Mutex::default(),
        route,
    });
    let span = info_span!("request", id = %trail.id);
    let served = next.run(Request::from_parts(parts, body)).instrument(span);
    let mut response = TRAIL.scope(Arc::clone(&trail), served).await;
    match trail.finish(&app, response.status()).await {
        // What goes over a satellite has no header that it does not need.
        Ok(true) if !trail.is_of_agent() => {
            if let Ok(id) = HeaderValue::try_from(trail.id.to_string()) {
                response.headers_mut().insert(REQUEST_ID, id);
            }
        }
        Ok(_) => {}
        Err(cause) if response.status().is_success() => {
            return Error::from(cause).into_response();
        }
        Err(cause) => error!(error = ?cause, "a refusal is missing in the audit log"),
    }
    response
}

/// The route with its ids and numbers; anything else in a path may be a mistake that is
/// nobody's business.
async fn filled(route: &str, parts: &mut axum::http::request::Parts) -> String {
    let mut path = route.to_owned();
    let Ok(given) = RawPathParams::from_request_parts(parts, &()).await else {
        return path;
    };
    for (name, value) in &given {
        let harmless = Uuid::parse_str(value).is_ok() || value.parse::<u64>().is_ok();
        let shown = if harmless { value } else { "*" };
        path = path.replace(&format!("{{{name}}}"), shown);
    }
    path
}

struct Trail {
    id: Uuid,
    at: Time,
    address: String,
    method: String,
    route: String,
    path: String,
    is_change: bool,
    known: Mutex<Known>,
}

#[derive(Clone, Default)]
struct Known {
    actor: Option<Actor>,
    concerns: Option<Tenant>,
    vessel: Option<VesselId>,
    order: Option<OrderId>,
    kept: bool,
}

impl Trail {
    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_of_agent(&self) -> bool {
        let known = self.known();
        let actor = known.actor.as_ref();
        actor.is_some_and(|actor| actor.kind == ActorKind::Agent)
    }

    /// Notes the answer; whether there is a line.
    async fn finish(&self, app: &App, status: StatusCode) -> db::Result<bool> {
        let known = self.known().clone();
        let code = i64::from(status.as_u16());
        if known.kept {
            // The line is there, and so is the change: the answer stands.
            if let Err(cause) = store::answered(&app.db, self.id, code).await {
                error!(error = ?cause, id = %self.id, "a status is missing in the audit log");
            }
            return Ok(true);
        }
        let Some(actor) = known.actor else {
            return Ok(false);
        };
        let is_read = status.is_success()
            && self.route.starts_with(ORDERS)
            && matches!(actor.tenant, Some(Tenant::Firm(_)));
        let is_tried = self.is_change && status != StatusCode::METHOD_NOT_ALLOWED;
        if !(is_read || is_tried) {
            return Ok(false);
        }
        let mut tx = app.db.begin().await?;
        let written = self.write(&mut tx, Some(status)).await?;
        tx.commit().await?;
        Ok(written)
    }

    /// Writes the line, if it is known who asks. Without a status what it tells of is done.
    async fn write(&self, tx: &mut Tx, status: Option<StatusCode>) -> db::Result<bool> {
        let known = self.known().clone();
        let Some(actor) = known.actor else {
            return Ok(false);
        };
        let is_done = status.is_none_or(|status| status.is_success());
        let order = known.order.or(self.id_after(ORDERS).map(OrderId));
        let named = known.vessel.or(actor.vessel);
        let mut vessel = named.or(self.id_after("/api/v1/vessels/{id}").map(VesselId));
        // Whoever is refused learns nothing here, and is in nobody's log but their own.
        let mut owner = None;
        if is_done {
            if let (None, Some(order)) = (vessel, order) {
                vessel = store::vessel_of(tx, order).await?;
            }
            if let Some(vessel) = vessel {
                owner = store::owner_of(tx, vessel).await?;
            }
        }
        let owner_id = owner.as_ref().map(|(operator, _)| operator.0);
        let (operator_id, firm_id) = match known.concerns.or(actor.tenant) {
            Some(Tenant::Operator(operator)) => (Some(operator.0), None),
            Some(Tenant::Firm(firm)) => (owner_id, Some(firm.0)),
            None => (
                owner_id.or(self.id_after("/api/v1/operators/{id}")),
                self.id_after("/api/v1/firms/{id}"),
            ),
        };
        let actor_name = match (actor.kind, owner) {
            (ActorKind::Agent, Some((_, vessel_name))) => vessel_name,
            _ => actor.name,
        };
        let line = Line {
            id: self.id,
            at: self.at,
            actor_kind: actor.kind,
            actor_id: actor.id,
            actor_name,
            token_id: actor.token,
            operator_id,
            firm_id,
            address: self.address.clone(),
            method: self.method.clone(),
            route: self.route.clone(),
            path: self.path.clone(),
            vessel_id: vessel,
            order_id: order,
            status: status.map(|status| i64::from(status.as_u16())),
        };
        store::insert(tx, &line).await?;
        Ok(true)
    }

    /// The id in the path, if the route begins so.
    fn id_after(&self, route: &str) -> Option<Uuid> {
        let begins = self.route.starts_with(route);
        let mut segments = self.path.split('/').filter(|_| begins);
        segments.find_map(|segment| Uuid::parse_str(segment).ok())
    }
}
