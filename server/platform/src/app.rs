//! State shared by all handlers and workers.

use crate::clock::Clock;
use crate::config::Serve;
use crate::db::{Db, Pools, Workload};
use crate::events::{Announcer, Event, Live, Places};
use crate::identity_provider::Provider;
use crate::outage::Disk;
use crate::password::Hashing;
use crate::request_rates::letters::Letters;
use crate::request_rates::{AcceptedCredentials, RequestRates};
use metrics_exporter_prometheus::PrometheusHandle;
use std::sync::Arc;
use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;

/// Application state: cheap to clone, one per process and one per test.
#[derive(Clone)]
pub struct App {
    /// The database.
    pub db: Db,
    /// State of the database's disk.
    pub disk: Arc<Disk>,
    /// Source of the current time.
    pub clock: Clock,
    /// Settings of `serve`.
    pub config: Arc<Serve>,
    /// Live event channel to this process's dashboards.
    pub live: Live,
    /// Streams of live events that are open.
    pub event_streams: Places,
    /// Events to be announced to other processes.
    pub announcer: Arc<Announcer>,
    /// Wakes the worker when there is a new job.
    pub work: Arc<Notify>,
    /// Requests of each caller in this minute.
    pub request_rates: Arc<RequestRates>,
    /// Uploads of each vessel in this day.
    pub uploads: Arc<RequestRates>,
    /// Sessions and tokens that were accepted lately.
    pub accepted: Arc<AcceptedCredentials>,
    /// Refusals of each caller in this minute.
    pub refusal_rates: Arc<RequestRates>,
    /// Limits on letters with one-time codes.
    pub letters: Arc<Letters>,
    /// Hashing of passwords, by a few at a time.
    pub hashing: Arc<Hashing>,
    /// Cached metadata of the OpenID Connect provider.
    pub provider: Arc<Provider>,
    /// Token that is cancelled when the server is to stop.
    pub stopping: CancellationToken,
    /// Source of the `/metrics` response.
    pub metrics: PrometheusHandle,
}

impl App {
    /// Creates the application on an open, migrated database.
    pub fn new(db: Db, clock: Clock, config: Serve, metrics: PrometheusHandle) -> App {
        App {
            db,
            disk: Arc::default(),
            clock,
            config: Arc::new(config),
            live: Live::new(),
            event_streams: Places::default(),
            announcer: Arc::default(),
            work: Arc::new(Notify::new()),
            request_rates: Arc::default(),
            uploads: Arc::new(RequestRates::daily()),
            accepted: Arc::default(),
            refusal_rates: Arc::default(),
            letters: Arc::default(),
            hashing: Arc::default(),
            provider: Arc::default(),
            stopping: CancellationToken::new(),
            metrics,
        }
    }

    /// Returns the same application, by the database connections of a workload.
    #[must_use]
    pub fn for_workload(&self, workload: Workload) -> App {
        App {
            db: self.db.for_workload(workload),
            ..self.clone()
        }
    }

    /// Returns the seconds without a request after which a session ends.
    pub fn idle_s(&self) -> f64 {
        f64::from(self.config.session_idle_hours) * 3600.0
    }

    /// Publishes an event whose transaction was committed.
    pub fn publish(&self, event: Event) {
        if matches!(self.db.pools(), Pools::Postgres(_)) {
            self.announcer.push(event.clone());
        }
        self.live.send(event);
        self.work.notify_one();
    }
}
