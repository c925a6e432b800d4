//! Live events as they reach the dashboards: server-sent events, and the listener that
//! receives those of other processes.
//!
//! Invariants: a dashboard that reconnects with the last id it saw gets the events that it
//! missed, some of them perhaps twice. A client that is signed out gets no more events.

mod announce;
mod listener;

pub use announce::announce;
pub use listener::EventListener;

use crate::access::Caller;
use crate::app::App;
use crate::error::{Error, Problem, Result};
use crate::events::{self, Event, Kind, Place, STREAMS_OF_USER};
use crate::ids::{EventId, OrderId, VesselId};
use crate::tenants::Tenant;
use axum::extract::{FromRef, State};
use axum::http::HeaderMap;
use axum::response::sse::{Event as Sent, KeepAlive, Sse};
use futures_util::stream::{self, Stream};
use serde::Serialize;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::time::Duration;
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::{RecvError, TryRecvError};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

/// Routes of the live events.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(follow_events))
}

/// Data of an event.
#[derive(Serialize, ToSchema)]
pub struct VesselEvent {
    /// The vessel concerned.
    pub vessel_id: VesselId,
    /// Kind of event.
    pub kind: Kind,
    /// Work order concerned, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order_id: Option<OrderId>,
}

/// Maximum length of a stream: after that the client reconnects and is authorized again.
const LONGEST_STREAM: Duration = Duration::from_mins(30);

/// Follow the fleet live
///
/// Server-sent events named `vessel`, whose data is a `VesselEvent`. With
/// `Last-Event-ID`, the events missed within the last day come first. A firm receives only the
/// events of its work orders. A user may have 32 streams open.
#[utoipa::path(get, path = "/events", tag = "fleet",
    params(("Last-Event-ID" = Option<Uuid>, Header, description = "The last event seen")),
    responses((status = 200, content_type = "text/event-stream", body = VesselEvent),
              (status = 401, body = Problem), (status = 429, body = Problem)))]
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
    let place = app.event_streams.take(caller.user.user_id);
    let place = place.ok_or(Error::TooManyStreams(STREAMS_OF_USER))?;
    // Subscribing before reading the past events ensures that none is lost in between.
    let receiver = app.live.subscribe();
    let missed = match last {
        Some(last) => events::since(&app.db, tenant, last).await?,
        None => Vec::new(),
    };
    let follower = Follower {
        ends: tokio::time::Instant::now() + LONGEST_STREAM,
        app,
        tenant,
        caller,
        receiver,
        pending: missed.into(),
        is_checked: false,
        last,
        _place: place,
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
    /// True once the caller was found valid after the pending events were gathered.
    is_checked: bool,
    last: Option<EventId>,
    _place: Place,
    ends: tokio::time::Instant,
}

impl Follower {
    async fn next(mut self) -> Option<(std::result::Result<Sent, Infallible>, Follower)> {
        if self.pending.is_empty() {
            self.gather().await?;
            self.is_checked = false;
        }
        // A client that was signed out, or whose token was revoked, gets no more events. Those
        // that were gathered together are checked together.
        if !self.is_checked && !self.caller.is_still_valid(&self.app).await.ok()? {
            return None;
        }
        self.is_checked = true;
        let event = self.pending.pop_front()?;
        self.last = Some(event.id);
        Some((Ok(sent(event)), self))
    }

    /// Waits for an event, and adds those that have come meanwhile. `None` ends the stream.
    async fn gather(&mut self) -> Option<()> {
        while self.pending.is_empty() {
            let received = tokio::select! {
                () = self.app.stopping.cancelled() => return None,
                () = tokio::time::sleep_until(self.ends) => return None,
                received = self.receiver.recv() => received,
            };
            match received {
                Ok(event) => self.add(event),
                Err(RecvError::Closed) => return None,
                Err(RecvError::Lagged(_)) => self.catch_up().await?,
            }
        }
        loop {
            match self.receiver.try_recv() {
                Ok(event) => self.add(event),
                Err(TryRecvError::Lagged(_)) => self.catch_up().await?,
                Err(TryRecvError::Empty | TryRecvError::Closed) => return Some(()),
            }
        }
    }

    /// Adds an event of the tenant, in the place of one about the same.
    fn add(&mut self, event: Event) {
        if event.is_for(self.tenant) {
            self.pending
                .retain(|known| !known.is_about_the_same(&event));
            self.pending.push_back(event);
        }
    }

    /// Reads the missed events from the database, after the live channel was too fast.
    async fn catch_up(&mut self) -> Option<()> {
        let Some(last) = self.last else {
            return Some(());
        };
        let missed = events::since(&self.app.db, self.tenant, last).await.ok()?;
        self.pending.extend(missed);
        Some(())
    }
}

fn sent(event: Event) -> Sent {
    let data = VesselEvent {
        vessel_id: event.vessel_id,
        kind: event.kind,
        order_id: event.about.map(OrderId),
    };
    Sent::default()
        .event("vessel")
        .id(event.id.to_string())
        .json_data(data)
        .expect("an id and a word are JSON")
}
