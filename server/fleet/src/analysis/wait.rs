//! Waiting for a vessel's analysis.

use super::queue;
use binnacle_platform::app::App;
use binnacle_platform::error::Result;
use binnacle_platform::ids::VesselId;
use std::time::{Duration, Instant};

/// Interval between checks of the queue.
const LOOK_AGAIN: Duration = Duration::from_millis(100);

/// Waits until a vessel's samples are analysed, but not for longer than that.
///
/// # Errors
/// When the queue cannot be reached.
pub async fn done(app: &App, vessel: VesselId, at_most: Duration) -> Result<()> {
    let begun = Instant::now();
    app.work.notify_one();
    while begun.elapsed() < at_most
        && !app.stopping.is_cancelled()
        && queue::is_under_way(&app.db, vessel, app.clock.now().into()).await?
    {
        // Another process may do the work.
        tokio::time::sleep(LOOK_AGAIN).await;
    }
    Ok(())
}
