//! Task that announces this process's events to the others.

use crate::app::App;
use std::time::Duration;
use tracing::warn;

/// Time in which events are gathered for one notification.
const GATHER_FOR: Duration = Duration::from_millis(100);
/// Pause after the database did not take a notification.
const RETRY_AFTER: Duration = Duration::from_secs(1);

/// Announces events until the server stops, the last ones then.
pub async fn announce(app: App) {
    let mut pause = GATHER_FOR;
    loop {
        let stops = tokio::select! {
            () = app.stopping.cancelled() => true,
            () = app.announcer.wait() => {
                tokio::time::sleep(pause).await;
                false
            }
        };
        pause = match app.announcer.announce_pending(&app.db).await {
            Ok(()) => GATHER_FOR,
            Err(error) => {
                warn!(%error, "live events wait to be announced");
                RETRY_AFTER
            }
        };
        if stops {
            return;
        }
    }
}
