//! Analysis worker: takes jobs from the queue, one after the other.

mod fold;

use binnacle_analysis::advice::sail_next;
use binnacle_fleet::analysis::Findings;
use binnacle_fleet::analysis::{AnalysisResult, Covered, input, store};
use binnacle_fleet::{alerts, analysis_queue, compasses, settings};
use binnacle_orders::verification;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::events;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use binnacle_priors::{self as priors, VesselPrior};
use fold::Folded;
use metrics::{counter, histogram};
use std::convert::Infallible;
use std::time::{Duration, Instant};
use tracing::{error, info, warn};

/// Interval between checks for jobs without a notification.
const POLL_EVERY: Duration = Duration::from_secs(1);
/// Interval between renewals of a job's lease: three per lease.
const RENEW_EVERY: Duration = Duration::from_secs(20);
/// Interval between removals of old events.
const PRUNE_EVERY: Duration = Duration::from_hours(1);

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Worked {
    /// A vessel was analysed, with new results for this number of compasses.
    Analysed(VesselId, usize),
    /// A job failed, and was requeued or given up.
    Failed(VesselId),
}

/// Runs jobs until the server stops. A job that has begun is finished.
pub async fn run(app: App) {
    let mut pruned = Instant::now();
    while !app.stopping.is_cancelled() {
        match step(&app).await {
            Ok(Some(_)) => continue,
            Ok(None) => {}
            Err(error) => error!(
                error = format!("{error:#}"),
                "the worker cannot reach its queue"
            ),
        }
        if pruned.elapsed() > PRUNE_EVERY {
            pruned = Instant::now();
            if let Err(error) = events::prune(&app.db, app.clock.now().into()).await {
                warn!(%error, "old events were not removed");
            }
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = app.work.notified() => {}
            () = tokio::time::sleep(POLL_EVERY) => {}
        }
    }
}

/// Does one job, if one is due.
///
/// # Errors
/// Fails when the queue cannot be reached; a job that fails is not an error here.
pub async fn step(app: &App) -> anyhow::Result<Option<Worked>> {
    let Some(job) = analysis_queue::claim(&app.db, app.clock.now().into()).await? else {
        return Ok(None);
    };
    let vessel = job.vessel_id;
    let begun = Instant::now();
    let outcome = match job.attempts {
        // Beyond this limit its worker died each time: the job crashes the process.
        ..=analysis_queue::MOST_ATTEMPTS => tokio::select! {
            done = work(app, job) => done,
            never = keep_lease(app, job) => match never {},
        },
        _ => Err(Error::Internal(anyhow::anyhow!(
            "its lease expired too often"
        ))),
    };
    histogram!("binnacle_analysis_seconds").record(begun.elapsed().as_secs_f64());
    let error = match outcome {
        Ok(count) => {
            counter!("binnacle_analyses_total", "result" => "done").increment(1);
            info!(%vessel, compasses_with_news = count, "vessel analysed");
            return Ok(Some(Worked::Analysed(vessel, count)));
        }
        Err(Error::Internal(error)) => format!("{error:#}"),
        Err(error) => error.to_string(),
    };
    counter!("binnacle_analyses_total", "result" => "failed").increment(1);
    let dead = analysis_queue::fail(&app.db, job, &error, app.clock.now().into()).await?;
    if dead {
        error!(%vessel, error, "the analysis failed too often and was given up");
    } else {
        warn!(%vessel, error, "the analysis failed and will be tried again");
    }
    Ok(Some(Worked::Failed(vessel)))
}

/// Renews a job's lease while the job runs.
async fn keep_lease(app: &App, job: analysis_queue::Job) -> Infallible {
    loop {
        tokio::time::sleep(RENEW_EVERY).await;
        if let Err(error) = analysis_queue::renew(&app.db, job, app.clock.now().into()).await {
            warn!(vessel = %job.vessel_id, %error, "a lease was not renewed");
        }
    }
}

/// Analyses a vessel's compasses and stores what is new.
async fn work(app: &App, job: analysis_queue::Job) -> Result<usize> {
    let mut results = Vec::new();
    let mut next_entry_at = None;
    let now: Time = app.clock.now().into();
    let compasses = compasses::of_vessel(&app.db, job.vessel_id).await?;
    for compass in &compasses {
        let stored = input::load(&app.db, job.vessel_id, compass.id, now.0).await?;
        next_entry_at = next_entry_at.into_iter().chain(stored.next_entry_at).min();
        if stored.segments.is_empty() {
            continue;
        }
        let prior = priors::find_or_choose(&app.db, job.vessel_id, compass.id, now).await?;
        results.extend(analyse_compass(app, job.vessel_id, compass.id, stored, prior).await?);
    }
    let limits = settings::find(&app.db, job.vessel_id).await?.alerts;
    let now: Time = app.clock.now().into();
    let mut tx = app.db.begin().await?;
    if !analysis_queue::finish(&mut tx, job).await? {
        return Err(Error::Internal(anyhow::anyhow!("the lease was lost")));
    }
    if let Some(time) = next_entry_at {
        let delay_s = time.seconds_since(now.0).max(0.0);
        analysis_queue::enqueue(&mut tx, job.vessel_id, now, delay_s).await?;
    }
    let mut events = Vec::new();
    for found in &results {
        let (compass, samples) = (found.compass_id, &found.analysis.samples);
        let verified = verification::after_analysis(&mut tx, job.vessel_id, compass, samples, now);
        let verified = Box::pin(verified);
        events.extend(verified.await?);
        events.extend(store::save(&mut tx, found, now).await?);
    }
    // Also without new results: the limits may have changed.
    for compass in &compasses {
        let (vessel, compass) = (job.vessel_id, compass.id);
        let unconfirmed = verification::unconfirmed_adjustment(&mut tx, vessel, compass).await?;
        let changed =
            alerts::reconcile_analysis(&mut tx, vessel, compass, &limits, unconfirmed, now);
        events.extend(changed.await?);
    }
    tx.commit().await?;
    for event in events {
        app.publish(event);
    }
    Ok(results.len())
}

/// Analyses a compass; `None` when its input has not changed.
async fn analyse_compass(
    app: &App,
    vessel_id: VesselId,
    compass_id: CompassId,
    stored: input::StoredInput,
    prior: VesselPrior,
) -> Result<Option<AnalysisResult>> {
    let last_hash = store::last_hash(&app.db, vessel_id, compass_id).await?;
    let logbook = stored.logbook.clone();
    let mut tx = app.db.begin().await?;
    let unverified = verification::awaited_since(&mut tx, vessel_id, compass_id).await?;
    tx.commit().await?;
    let db = &app.db;
    let from = unverified.map(|since| since.0);
    let folded = fold::fold(db, vessel_id, compass_id, stored, prior, last_hash, from).await?;
    let found = match folded {
        Folded::New(found) => *found,
        Folded::Unchanged => return Ok(None),
    };
    let summary = tokio::task::spawn_blocking(move || {
        let analysis = &found.analysis;
        let covered = Covered {
            coverage: analysis.coverage.clone(),
            sail_next: sail_next(analysis),
            references: analysis.current_epoch().and_then(|epoch| epoch.references),
            predictions: analysis.predictions,
        };
        AnalysisResult {
            vessel_id,
            compass_id,
            input_hash: found.input_hash,
            findings: Findings::from_analysis(analysis, &logbook),
            covered,
            analysis: found.analysis,
            segments: found.segments,
        }
    });
    Ok(Some(summary.await?))
}
