//! The running agent: inputs to samples, samples to the spool, and the corrected heading out, per
//! observation, second and output interval.
//!
//! One task owns the state; nothing is locked. When the disk is slow, this task waits, its channel
//! fills, and the inputs wait in turn. A recording that is replayed fast is throttled and never
//! lost.

mod alert_watch;
mod bridge_alerts;
mod heading;
mod live_status;
mod service_manager;
mod start;
mod store_samples;

use crate::acquisition::Acquisition;
use crate::alert::{
    AlarmSentence, AlertMonitor, AlertRecord, DifferenceMonitor, HeadingDifference,
    InterferenceMonitor,
};
use crate::config::{Config, UploadPlan};
use crate::raw_log::{RawLog, Second};
use crate::sampler::{Exclusion, Tally};
use crate::spool::{Pending, Seal, Spool, StoredReport};
use crate::status::Status;
use crate::uplink::UplinkHandle;
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_input::InputStats;
use binnacle_instruments::Latest;
use binnacle_instruments::config::SilenceConfig;
use binnacle_nmea::sentence::Acn;
use binnacle_observation::Observation;
use binnacle_output::{AlertSentences, HeadingSentences, Outputs, SharedOutputs};
use binnacle_wire::alert::ShipAlert;
use service_manager::ServiceManager;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::{Instant, MissedTickBehavior, interval, sleep_until};
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

/// Samples that are written to the spool together; fewer are written after a second.
pub(crate) const SAMPLES_PER_COMMIT: usize = 64;
/// Deliveries of observations that may wait; they are lost when the agent dies.
const CHANNEL_CAPACITY: usize = 8;
const TICK: Duration = Duration::from_secs(1);

/// Runs until `shutdown`; everything settled is in the spool then.
pub(crate) async fn run(config: Config, shutdown: CancellationToken) -> anyhow::Result<()> {
    let (spool, _alone) = Spool::open_for_agent(&config.data_dir).await?;
    let agent = Agent::start(config, spool.clone(), &shutdown).await?;
    ServiceManager::report_ready();
    agent.run(shutdown).await;
    spool.close().await;
    Ok(())
}

struct Agent {
    acquisition: Box<Acquisition>,
    /// Server's time of the last contact.
    last_contact: Option<Timestamp>,
    silence: SilenceConfig,
    spool: Spool,
    spool_limit_bytes: u64,
    raw_log: RawLog,
    plan: UploadPlan,
    uplink_handle: UplinkHandle,
    /// Reports of the officers.
    reports: Vec<StoredReport>,
    observations: mpsc::Receiver<Vec<Observation>>,
    inputs: Vec<(String, Arc<InputStats>)>,
    outputs: Outputs,
    /// Commands that the outputs' receivers send.
    alert_commands: mpsc::Receiver<Acn>,
    sentences: HeadingSentences,
    shared_outputs: SharedOutputs,
    exclusion: watch::Sender<Option<Exclusion>>,
    alert_monitor: AlertMonitor,
    difference_monitor: DifferenceMonitor,
    interference_monitor: InterferenceMonitor,
    /// Alert as the spool has it.
    stored_alert: Option<AlertRecord>,
    /// Heading-difference alarm as the spool has it.
    stored_difference: Option<HeadingDifference>,
    /// Reading of the compass that was last offered to the outputs.
    offered_reading: Option<Latest<CompassHeading>>,
    /// Set if the last heading sent was withheld because its band was too wide.
    withheld: bool,
    acknowledged: watch::Receiver<Option<Uuid>>,
    alarm: Option<AlarmSentence>,
    alert_sentences: Option<AlertSentences>,
    status: watch::Sender<Arc<Status>>,
    service_manager: ServiceManager,
    uplink: tokio::task::JoinHandle<()>,
    unstored: Unstored,
    windows: Tally,
    /// Problems with sources, as they were last logged.
    source_problems: Vec<String>,
}

/// Results of the sampler that the spool does not have yet.
#[derive(Debug, Default)]
struct Unstored {
    samples: Vec<Sample>,
    tally: Tally,
    /// Revisions of alerts.
    alerts: Vec<ShipAlert>,
    /// Reason why the spool does not store them.
    problem: Option<String>,
    /// Unsealed contents of the spool.
    pending: Pending,
    /// GNSS time when the tally was last sealed.
    tally_since: Option<Timestamp>,
}

impl Agent {
    async fn run(mut self, shutdown: CancellationToken) {
        let mut second = interval(TICK);
        second.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut exclusion = self.exclusion.subscribe();
        loop {
            let output = self.next_output();
            tokio::select! {
                () = shutdown.cancelled() => break,
                Some(observations) = self.observations.recv() => self.observe(&observations).await,
                _ = second.tick() => self.run_every_second().await,
                () = sleep_until(output) => self.run_output_timer().await,
                Ok(()) = self.uplink_handle.settings.changed() => {
                    let settings = self.uplink_handle.settings.borrow_and_update().clone();
                    self.acquisition.sampler.set_settings(settings);
                }
                Ok(()) = self.uplink_handle.link.changed() => {
                    let contact = self.uplink_handle.link.borrow_and_update().last_contact;
                    if let Some(time) = contact.filter(|_| contact != self.last_contact) {
                        self.acquisition.correct_reference_time(time, Instant::now());
                    }
                    self.last_contact = contact;
                }
                Some(command) = self.alert_commands.recv() => self.command_alert(&command),
                Ok(()) = exclusion.changed() => {
                    let exclusion = *exclusion.borrow_and_update();
                    self.acquisition.sampler.set_exclusion(exclusion);
                }
                Ok(()) = self.acknowledged.changed() => {
                    let seen = *self.acknowledged.borrow_and_update();
                    if let Some(id) = seen {
                        self.acknowledge_alert(id);
                    }
                }
            }
        }
        ServiceManager::report_stopping();
        self.stop().await;
    }

    /// Stores what has settled, and lets the uplink finish its exchange.
    async fn stop(mut self) {
        self.observations.close();
        self.acquisition.sampler.finish();
        self.collect();
        self.store(Seal::Full).await;
        self.save_difference().await;
        self.save_checkpoints().await;
        self.raw_log.flush(Instant::now());
        if let Err(error) = self.uplink.await {
            tracing::error!(%error, "the uplink failed");
        }
        tracing::info!("stopped");
    }

    async fn observe(&mut self, observations: &[Observation]) {
        let heard = Instant::now();
        for observation in observations {
            self.acquisition.observe(observation, heard);
            if let Some(time) = self.acquisition.time() {
                let (readings, stale) =
                    (&self.acquisition.readings, self.silence.stale_s.duration());
                let second = || Second::from_readings(time, readings, stale, heard);
                self.raw_log.record(time, second, heard);
            }
        }
        self.update_alert();
        self.apply_commands(observations);
        self.send_new_reading();
        if !self.acquisition.sampler.has_samples() {
            return;
        }
        self.collect();
        let seal = self.seal_due();
        if seal == Seal::All
            || !self.unstored.alerts.is_empty()
            || self.unstored.samples.len() >= SAMPLES_PER_COMMIT
        {
            self.store(seal).await;
        }
    }

    async fn run_every_second(&mut self) {
        self.update_alert();
        self.compare_headings(Instant::now());
        if self.watch_interference() {
            self.save_checkpoints().await;
        }
        self.collect();
        let seal = self.seal_due();
        let unstored = &self.unstored;
        if seal == Seal::All || !unstored.samples.is_empty() || !unstored.alerts.is_empty() {
            self.store(seal).await;
        }
        self.save_alert().await;
        self.save_difference().await;
        self.uplink_handle
            .ship_time
            .send_replace(self.acquisition.time());
        match self.spool.exclusion().await {
            Ok(exclusion) => {
                // The command line stores it there.
                self.exclusion
                    .send_if_modified(|known| std::mem::replace(known, exclusion) != exclusion);
            }
            Err(error) => tracing::error!(%error, "the spool cannot be read"),
        }
        match self.spool.reports().await {
            Ok(reports) => self.reports = reports,
            Err(error) => tracing::error!(%error, "the spool cannot be read"),
        }
        let status = self.build_status().await;
        for problem in &status.source_problems {
            if !self.source_problems.contains(problem) {
                tracing::warn!("{problem}");
            }
        }
        self.source_problems.clone_from(&status.source_problems);
        if !self.uplink.is_finished() {
            self.service_manager.feed_watchdog(&status);
        }
        self.status.send_replace(Arc::new(status));
    }

    fn collect(&mut self) {
        let tally = self.acquisition.sampler.take_tally();
        self.windows.add_all(&tally);
        self.unstored.tally.add_all(&tally);
        let samples = self.acquisition.sampler.take_samples();
        self.unstored.samples.extend(samples);
        if self.unstored.tally_since.is_none() {
            self.unstored.tally_since = self.acquisition.time();
        }
    }
}
