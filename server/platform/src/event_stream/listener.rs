//! PostgreSQL listener that receives the events of all processes.

use crate::app::App;
use crate::db::{Db, Pools};
use crate::events::{self, CHANNEL};
use crate::time::Time;
use sqlx::PgPool;
use sqlx::postgres::PgListener;
use std::time::Duration;
use tracing::warn;

const RECONNECT_AFTER: Duration = Duration::from_secs(1);

/// Listener for the events of other processes; does nothing on SQLite.
pub struct EventListener(Option<PgListener>);

impl EventListener {
    /// Begins to listen: every event committed from now on will be received.
    pub async fn open(db: &Db) -> Result<EventListener, sqlx::Error> {
        match db.pools() {
            Pools::Sqlite { .. } => Ok(EventListener(None)),
            Pools::Postgres(pool) => Ok(EventListener(Some(connect(pool).await?))),
        }
    }

    /// Forwards events until the server stops. After an interruption the missed events are
    /// read from the database.
    pub async fn listen(self, app: App) {
        let (Some(mut listener), Pools::Postgres(pool)) = (self.0, app.db.pools()) else {
            return;
        };
        loop {
            let error = tokio::select! {
                () = app.stopping.cancelled() => return,
                error = forward(&app, listener) => error,
            };
            let broke_at = Time(app.clock.now());
            warn!(%error, "live events are interrupted");
            listener = tokio::select! {
                () = app.stopping.cancelled() => return,
                listener = reconnect(pool) => listener,
            };
            match events::all_since(&app.db, broke_at).await {
                Ok(missed) => missed.into_iter().for_each(|event| app.live.send(event)),
                Err(error) => warn!(%error, "live events were missed"),
            }
        }
    }
}

async fn connect(pool: &PgPool) -> Result<PgListener, sqlx::Error> {
    let mut listener = PgListener::connect_with(pool).await?;
    listener.listen(CHANNEL).await?;
    // A broken connection must be reported as an error.
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

/// Forwards events until the connection breaks.
async fn forward(app: &App, mut listener: PgListener) -> sqlx::Error {
    loop {
        let notice = match listener.try_recv().await {
            Ok(Some(notice)) => notice,
            Ok(None) => return sqlx::Error::PoolTimedOut,
            Err(error) => return error,
        };
        match app.announcer.read(notice.payload()) {
            Ok(events) => {
                for event in events {
                    app.live.send(event);
                    app.work.notify_one();
                }
            }
            Err(error) => warn!(%error, "live events cannot be read"),
        }
    }
}
