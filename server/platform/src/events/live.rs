//! From the process that makes an event to the dashboards of all processes.

use super::{Event, store};
use crate::app::App;
use crate::db::{Db, Pools};
use crate::time::Time;
use sqlx::PgPool;
use sqlx::postgres::PgListener;
use std::time::Duration;
use tokio::sync::broadcast::{Receiver, Sender};
use tracing::warn;

/// The channel of PostgreSQL's NOTIFY.
pub(super) const CHANNEL: &str = "binnacle_events";
/// Events that a slow dashboard may lag behind before it must read them again.
const BUFFERED: usize = 256;
const RECONNECT_AFTER: Duration = Duration::from_secs(1);

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
        // A channel without listeners is not an error.
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
    /// commit itself has done it, through [`Line`].
    pub fn publish(&self, event: Event) {
        if matches!(self.db.pools(), Pools::Sqlite { .. }) {
            self.live.tell(event);
            self.work.notify_one();
        }
    }
}

/// The line on which PostgreSQL tells of other processes' events; none on SQLite.
pub struct Line(Option<PgListener>);

impl Line {
    /// Begins to listen; what is committed from now on will be heard.
    pub async fn open(db: &Db) -> Result<Line, sqlx::Error> {
        match db.pools() {
            Pools::Sqlite { .. } => Ok(Line(None)),
            Pools::Postgres(pool) => Ok(Line(Some(connect(pool).await?))),
        }
    }

    /// Passes on what is heard until the server stops. After a break, what was
    /// missed is read from the database.
    pub async fn listen(self, app: App) {
        let (Some(mut listener), Pools::Postgres(pool)) = (self.0, app.db.pools()) else {
            return;
        };
        loop {
            let error = tokio::select! {
                () = app.stopping.cancelled() => return,
                error = hear(&app, listener) => error,
            };
            let broke_at = Time(app.clock.now());
            warn!(%error, "live events are interrupted");
            listener = tokio::select! {
                () = app.stopping.cancelled() => return,
                listener = reconnect(pool) => listener,
            };
            match store::all_since(&app.db, broke_at).await {
                Ok(missed) => missed.into_iter().for_each(|event| app.live.tell(event)),
                Err(error) => warn!(%error, "live events were missed"),
            }
        }
    }
}

async fn connect(pool: &PgPool) -> Result<PgListener, sqlx::Error> {
    let mut listener = PgListener::connect_with(pool).await?;
    listener.listen(CHANNEL).await?;
    // A broken connection is an error here, not silence.
    listener.eager_reconnect(false);
    Ok(listener)
}

async fn reconnect(pool: &PgPool) -> PgListener {
    loop {
        tokio::time::sleep(RECONNECT_AFTER).await;
        match connect(pool).await {
            Ok(listener) => return listener,
            Err(error) => warn!(%error, "live events are still interrupted"),
        }
    }
}

/// Passes on what is heard until the connection breaks.
async fn hear(app: &App, mut listener: PgListener) -> sqlx::Error {
    loop {
        let notice = match listener.try_recv().await {
            Ok(Some(notice)) => notice,
            Ok(None) => return sqlx::Error::PoolTimedOut,
            Err(error) => return error,
        };
        match serde_json::from_str(notice.payload()) {
            Ok(event) => app.live.tell(event),
            Err(error) => warn!(%error, "a live event cannot be read"),
        }
        app.work.notify_one();
    }
}
