//! From the process that makes an event to the dashboards of all processes.

use super::Event;
use crate::app::App;
use crate::db::Db;
use sqlx::postgres::PgListener;
use std::time::Duration;
use tokio::sync::broadcast::{Receiver, Sender};
use tracing::warn;

/// The channel of PostgreSQL's NOTIFY.
pub(super) const CHANNEL: &str = "binnacle_events";
/// Events that a slow dashboard may lag behind before it must read them again.
const BUFFERED: usize = 256;
const RECONNECT_AFTER: Duration = Duration::from_secs(5);

/// The dashboards of this process.
#[derive(Clone, Debug)]
pub struct Live(Sender<Event>);

impl Live {
    /// Without anyone listening yet.
    pub fn new() -> Live {
        Live(Sender::new(BUFFERED))
    }

    /// Listens from now on.
    pub fn follow(&self) -> Receiver<Event> {
        self.0.subscribe()
    }

    /// Tells everyone who listens in this process.
    pub fn tell(&self, event: Event) {
        // No listener is not an error.
        let _ = self.0.send(event);
    }
}

impl Default for Live {
    fn default() -> Live {
        Live::new()
    }
}

impl App {
    /// Makes an event known whose transaction was committed. On PostgreSQL the
    /// commit itself has done it, through [`listen`].
    pub fn publish(&self, event: Event) {
        if matches!(self.db, Db::Sqlite { .. }) {
            self.live.tell(event);
            self.work.notify_one();
        }
    }
}

/// Hears the other processes' events until the server stops; on SQLite there are
/// none.
pub async fn listen(app: App) {
    let Db::Postgres(pool) = &app.db else {
        return;
    };
    loop {
        let stopped = tokio::select! {
            () = app.stopping.cancelled() => return,
            stopped = hear(&app, pool) => stopped,
        };
        if let Err(error) = stopped {
            warn!(%error, "live events are interrupted; dashboards poll meanwhile");
        }
        tokio::select! {
            () = app.stopping.cancelled() => return,
            () = tokio::time::sleep(RECONNECT_AFTER) => {}
        }
    }
}

async fn hear(app: &App, pool: &sqlx::PgPool) -> Result<(), sqlx::Error> {
    let mut listener = PgListener::connect_with(pool).await?;
    listener.listen(CHANNEL).await?;
    loop {
        let notice = listener.recv().await?;
        match serde_json::from_str(notice.payload()) {
            Ok(event) => app.live.tell(event),
            Err(error) => warn!(%error, "a live event cannot be read"),
        }
        app.work.notify_one();
    }
}
