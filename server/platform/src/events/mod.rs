//! Live events for dashboards.
//!
//! Invariants: an event is stored in the transaction that makes it true,
//! and reaches the dashboards of every server process on the same database: on
//! PostgreSQL through LISTEN and NOTIFY, on SQLite (one process) directly. A
//! dashboard that comes back with the last id it saw gets what it missed, some of
//! it perhaps twice.

mod live;
mod store;

pub use live::{Line, Live};
pub use store::{insert, insert_of_order, prune};

use crate::access::Caller;
use crate::app::App;
use crate::db::DomainEvent;
use crate::error::{Problem, Result};
use crate::ids::{EventId, FirmId, OperatorId, OrderId, VesselId};
use crate::tenants::Tenant;
use crate::time::Time;
use axum::extract::{FromRef, State};
use axum::http::HeaderMap;
use axum::response::sse::{Event as Sent, KeepAlive, Sse};
use futures_util::stream::{self, Stream};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::time::Duration;
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::RecvError;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

/// The routes of this part.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(follow_events))
}

/// Kind of change to a vessel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = EventKind)]
pub enum Kind {
    /// A batch came.
    Batch,
    /// A compass has a new model.
    Model,
    /// Something was reported, amended or withdrawn.
    Logbook,
    /// An alert was raised, says something else, was acknowledged or cleared.
    Alert,
    /// A work order has gone on.
    WorkOrder,
    /// A port call was entered, amended or withdrawn.
    PortCall,
    /// The schedule has another plan for it.
    Schedule,
    /// A compass is to be adjusted soon, or sooner than before.
    Need,
}

/// An event, with those who may know of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, sqlx::FromRow)]
pub struct Event {
    /// Its id, by which a dashboard resumes.
    pub id: EventId,
    /// Operator of the vessel.
    pub operator_id: OperatorId,
    /// The firm that receives the event; none if the operator does.
    pub firm_id: Option<FirmId>,
    /// The work order, if it is of one.
    pub order_id: Option<OrderId>,
    /// The vessel concerned.
    pub vessel_id: VesselId,
    /// Kind of event.
    pub kind: Kind,
}

/// A live event was stored, in the transaction that makes it true.
pub struct EventStored {
    /// The event.
    pub event: Event,
    /// Time of the event.
    pub at: Time,
}

impl DomainEvent for EventStored {}

/// The data of an event.
#[derive(Serialize, ToSchema)]
pub struct VesselEvent {
    /// The vessel concerned.
    pub vessel_id: VesselId,
    /// Kind of event.
    pub kind: Kind,
    /// The work order, if it is of one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order_id: Option<OrderId>,
}

/// Maximum length of a stream: after that the client reconnects and is authorized again.
const LONGEST_STREAM: Duration = Duration::from_mins(30);

/// Follow the fleet live
///
/// Server-sent events named `vessel`, whose data is a `VesselEvent`. With
/// `Last-Event-ID`, the events missed within the last day come first. A firm receives only the
/// events of its work orders.
#[utoipa::path(get, path = "/events", tag = "fleet",
    params(("Last-Event-ID" = Option<Uuid>, Header, description = "The last event seen")),
    responses((status = 200, content_type = "text/event-stream", body = VesselEvent),
              (status = 401, body = Problem)))]
async fn follow_events(
    State(app): State<App>,
    caller: Caller,
    headers: HeaderMap,
) -> Result<Sse<impl Stream<Item = std::result::Result<Sent, Infallible>>>> {
    let last = headers
        .get("last-event-id")
        .and_then(|value| value.to_str().ok())
        .and_then(|text| Uuid::parse_str(text).ok())
        .map(EventId);
    let tenant = caller.party()?;
    // Listening begins before the look back, so that nothing falls in between.
    let receiver = app.live.follow();
    let missed = match last {
        Some(last) => store::since(&app.db, tenant, last).await?,
        None => Vec::new(),
    };
    let follower = Follower {
        ends: tokio::time::Instant::now() + LONGEST_STREAM,
        app,
        tenant,
        caller,
        receiver,
        pending: missed.into(),
        last,
    };
    let stream = stream::unfold(follower, Follower::next);
    Ok(Sse::new(stream).keep_alive(KeepAlive::new().interval(Duration::from_secs(15))))
}

struct Follower {
    app: App,
    tenant: Tenant,
    caller: Caller,
    receiver: Receiver<Event>,
    pending: VecDeque<Event>,
    last: Option<EventId>,
    ends: tokio::time::Instant,
}

impl Follower {
    async fn next(mut self) -> Option<(std::result::Result<Sent, Infallible>, Follower)> {
        loop {
            if let Some(event) = self.pending.pop_front() {
                // A client that was signed out, or whose token was revoked, gets no more events.
                if !self.caller.still_vouched_for(&self.app).await.ok()? {
                    return None;
                }
                self.last = Some(event.id);
                return Some((Ok(event.to_sent()), self));
            }
            let received = tokio::select! {
                () = self.app.stopping.cancelled() => return None,
                () = tokio::time::sleep_until(self.ends) => return None,
                received = self.receiver.recv() => received,
            };
            match received {
                Ok(event) if event.is_for(self.tenant) => self.pending.push_back(event),
                Ok(_) => {}
                Err(RecvError::Closed) => return None,
                Err(RecvError::Lagged(_)) => self.catch_up().await?,
            }
        }
    }

    /// Too slow for the live channel: reads what was missed from the database.
    async fn catch_up(&mut self) -> Option<()> {
        let Some(last) = self.last else {
            return Some(());
        };
        let missed = store::since(&self.app.db, self.tenant, last).await.ok()?;
        self.pending.extend(missed);
        Some(())
    }
}

impl Event {
    fn is_for(&self, tenant: Tenant) -> bool {
        match tenant {
            Tenant::Operator(operator) => self.operator_id == operator && self.firm_id.is_none(),
            Tenant::Firm(firm) => self.firm_id == Some(firm),
        }
    }

    fn to_sent(self) -> Sent {
        let data = VesselEvent {
            vessel_id: self.vessel_id,
            kind: self.kind,
            order_id: self.order_id,
        };
        Sent::default()
            .event("vessel")
            .id(self.id.to_string())
            .json_data(data)
            .expect("an id and a word are JSON")
    }
}
