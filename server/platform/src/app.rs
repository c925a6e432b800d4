//! State shared by all handlers and workers.

use crate::clock::Clock;
use crate::config::Serve;
use crate::db::{Db, Pools};
use crate::events::{Event, Live};
use crate::identity_provider::Provider;
use crate::password::Hashing;
use metrics_exporter_prometheus::PrometheusHandle;
use std::sync::Arc;
use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;

/// Application state: cheap to clone, one per process and one per test.
#[derive(Clone)]
pub struct App {
    /// The database.
    pub db: Db,
    /// Source of the current time.
    pub clock: Clock,
    /// Settings of `serve`.
    pub config: Arc<Serve>,
    /// Live event channel to this process's dashboards.
    pub live: Live,
    /// Wakes the worker when there is a new job.
    pub work: Arc<Notify>,
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
            clock,
            config: Arc::new(config),
            live: Live::new(),
            work: Arc::new(Notify::new()),
            hashing: Arc::default(),
            provider: Arc::default(),
            stopping: CancellationToken::new(),
            metrics,
        }
    }

    /// Returns the seconds without a request after which a session ends.
    pub fn idle_s(&self) -> f64 {
        f64::from(self.config.session_idle_hours) * 3600.0
    }

    /// Publishes an event whose transaction was committed, to this process. On PostgreSQL
    /// the commit itself has notified all processes.
    pub fn publish(&self, event: Event) {
        if matches!(self.db.pools(), Pools::Sqlite { .. }) {
            self.live.send(event);
            self.work.notify_one();
        }
    }
}
