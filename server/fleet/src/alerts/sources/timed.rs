//! Source of alerts: time alone.

use super::agent_alerts::reconcile_reports;
use crate::alerts::causes::{CAUSES, Ending, Facts, Silence, Source, evaluate};
use crate::alerts::publish::publish_changes;
use crate::alerts::reconcile::reconcile_source;
use crate::alerts::store;
use crate::settings::AlertLimits;
use binnacle_platform::app::App;
use binnacle_platform::error::Result;
use binnacle_platform::time::Time;
use std::time::Duration;
use tracing::error;

/// Interval between checks.
const CHECK_EVERY: Duration = Duration::from_mins(1);

/// Checks the alerts of the clock until the server stops.
pub async fn watch(app: App) {
    while !app.stopping.is_cancelled() {
        if let Err(error) = check_timed(&app).await {
            error!(?error, "the timed alerts could not be checked");
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(CHECK_EVERY) => {}
        }
    }
}

/// Raises and clears the alerts that time alone does.
///
/// # Errors
/// Fails when the database does.
pub async fn check_timed(app: &App) -> Result<()> {
    check_silence(app).await?;
    end_quiet(app).await
}

/// Raises alerts of agents that have fallen silent, and clears those of agents that have not.
///
/// # Errors
/// Fails when the database does.
pub async fn check_silence(app: &App) -> Result<()> {
    let now: Time = app.clock.now().into();
    for last in store::last_uploads(&app.db).await? {
        let limits = match &last.limits {
            Some(text) => serde_json::from_str(text)?,
            None => AlertLimits::default(),
        };
        let desired = evaluate(Facts::Clock(&Silence {
            last_upload: last.last_at,
            limits: &limits,
            now,
        }));
        if desired.is_empty() == (last.alerts == 0) {
            continue;
        }
        let (vessel, compass) = (last.vessel_id, last.compass_id);
        let mut tx = app.db.begin().await?;
        let source = Source::Clock;
        let event = reconcile_source(&mut tx, vessel, compass, source, &desired, now).await?;
        tx.commit().await?;
        if let Some(event) = event {
            app.publish(event);
        }
    }
    Ok(())
}

/// Ends the alerts that nothing has shown for the time that their row states.
async fn end_quiet(app: &App) -> Result<()> {
    let now: Time = app.clock.now().into();
    for row in &CAUSES {
        let Ending::AfterSilence { seconds } = row.ending else {
            continue;
        };
        let before = Time(now.0.plus_seconds(-seconds));
        for (vessel, compass) in store::not_updated_since(&app.db, row.cause, before).await? {
            let mut tx = app.db.begin().await?;
            let event = if row.source() == Source::Agent {
                // Reports of the agent tell whether it is over.
                store::lock(&mut tx, vessel, compass).await?;
                let until = Some(now.0);
                let changes = reconcile_reports(&mut tx, vessel, compass, until, now).await?;
                publish_changes(&mut tx, vessel, &changes, now).await?
            } else {
                reconcile_source(&mut tx, vessel, compass, row.source(), &[], now).await?
            };
            tx.commit().await?;
            if let Some(event) = event {
                app.publish(event);
            }
        }
    }
    Ok(())
}
