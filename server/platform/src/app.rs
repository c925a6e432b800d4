//! What every handler and the worker share.

use crate::clock::Clock;
use crate::config::Serve;
use crate::db::Db;
use crate::events::Live;
use crate::oidc::Provider;
use metrics_exporter_prometheus::PrometheusHandle;
use std::sync::Arc;
use tokio::sync::{Notify, Semaphore};
use tokio_util::sync::CancellationToken;

/// Cheap to clone; one in the process (one in each test).
#[derive(Clone)]
pub struct App {
    /// The database.
    pub db: Db,
    /// The time.
    pub clock: Clock,
    /// What `serve` was told.
    pub config: Arc<Serve>,
    /// Live events to this process's dashboards.
    pub live: Live,
    /// Wakes the worker when there is a new job.
    pub work: Arc<Notify>,
    /// Passwords being hashed at once: each takes 19 MB and a core.
    pub hashing: Arc<Semaphore>,
    /// Plans for correctors being made at once: each takes a core for a second or two, and an
    /// adjuster at the berth waits for it.
    pub planning: Arc<Semaphore>,
    /// Who else's word one may sign in by, as far as is known.
    pub provider: Arc<Provider>,
    /// Cancelled when the server is to stop.
    pub stopping: CancellationToken,
    /// Where `/metrics` reads.
    pub metrics: PrometheusHandle,
}

impl App {
    /// An application on an open, migrated database.
    pub fn new(db: Db, clock: Clock, config: Serve, metrics: PrometheusHandle) -> App {
        App {
            db,
            clock,
            config: Arc::new(config),
            live: Live::new(),
            work: Arc::new(Notify::new()),
            hashing: Arc::new(Semaphore::new(2)),
            planning: Arc::new(Semaphore::new(2)),
            provider: Arc::default(),
            stopping: CancellationToken::new(),
            metrics,
        }
    }

    /// After so long without a request a session ends.
    pub fn idle_s(&self) -> f64 {
        f64::from(self.config.session_idle_hours) * 3600.0
    }
}
