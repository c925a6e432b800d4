//! The running agent: inputs into the ship, samples into the spool, the
//! corrected heading out, once around per observation, second and interval.
//!
//! One task owns the ship; nothing is locked. When the disk is slow, this task
//! waits, its channel fills, and the inputs wait in turn: a recording that is
//! played fast is throttled and never lost.

mod store_samples;

use crate::acquisition::Acquisition;
use crate::alert::{ActiveCard, AlertMonitor, AlertRecord};
use crate::card_invalidation;
use crate::clock;
use crate::config::{Config, InputConfig, SilenceConfig, UploadPlan};
use crate::corrected_heading::{self, CorrectedHeading, CorrectionInputs};
use crate::input::{self, InputStats};
use crate::instruments::Latest;
use crate::instruments::Observation;
use crate::output::{AlarmSentence, Outputs, Quality, heading_sentences};
use crate::page::{self, PageState};
use crate::raw_log::{RawLog, Second};
use crate::sampler::Exclusion;
use crate::sampler::Tally;
use crate::short_burst::{self, FileModem};
use crate::spool::{Pending, Seal, Spool, StoredReport};
use crate::status::{InputReport, ModelStatus, Status, offline_status};
use crate::uplink::{self, UplinkHandle};
use anyhow::Context;
use binnacle_magnetics::sample::Sample;
use binnacle_magnetics::time::Timestamp;
use binnacle_wire::alert::ShipAlert;
use binnacle_wire::messages::CardWithdrawn;
use rand::RngExt;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::{Instant, MissedTickBehavior, interval};
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

/// Samples are written to the spool when there are so many, or after a second.
pub(crate) const SAMPLES_PER_COMMIT: usize = 64;
/// Deliveries of observations that may wait: what is here dies with the agent.
const CHANNEL_CAPACITY: usize = 8;
const SECOND: Duration = Duration::from_secs(1);
/// Variation at twenty knots changes by less than a tenth of a degree meanwhile.
const POSITION_MAX_AGE: Duration = Duration::from_mins(10);

/// Runs until `shutdown`; everything settled is in the spool then.
pub(crate) async fn run(config: Config, shutdown: CancellationToken) -> anyhow::Result<()> {
    let (spool, _alone) = Spool::open_for_agent(&config.data_dir).await?;
    let agent = Agent::start(config, spool.clone(), &shutdown).await?;
    agent.run(shutdown).await;
    spool.set_page_address(None).await.ok();
    spool.close().await;
    Ok(())
}

struct Agent {
    acquisition: Acquisition,
    /// The shore's time when it was last heard of.
    last_contact: Option<Timestamp>,
    silence: SilenceConfig,
    spool: Spool,
    spool_limit_bytes: u64,
    raw_log: RawLog,
    plan: UploadPlan,
    uplink_handle: UplinkHandle,
    /// What officers reported.
    reports: Vec<StoredReport>,
    observations: mpsc::Receiver<Vec<Observation>>,
    inputs: Vec<(String, Arc<InputStats>)>,
    outputs: Outputs,
    interval: Duration,
    exclusion: watch::Sender<Option<Exclusion>>,
    alert_monitor: AlertMonitor,
    /// What the spool has of the lookout's alert.
    stored_alert: Option<AlertRecord>,
    /// Whether the last heading sent was known too badly to be given out.
    withheld: bool,
    acknowledged: watch::Receiver<Option<Uuid>>,
    alarm: Option<AlarmSentence>,
    status: watch::Sender<Arc<Status>>,
    uplink: tokio::task::JoinHandle<()>,
    unstored: Unstored,
    windows: Tally,
}

/// What the sampler has finished and the spool does not have yet.
#[derive(Debug, Default)]
struct Unstored {
    samples: Vec<Sample>,
    tally: Tally,
    /// Revisions of alerts.
    alerts: Vec<ShipAlert>,
    /// Why the spool does not take them.
    problem: Option<String>,
    /// What the spool has that is not sealed.
    pending: Pending,
    /// The ship's time when the tally was last sealed.
    tally_since: Option<Timestamp>,
}

impl Agent {
    async fn start(
        config: Config,
        spool: Spool,
        shutdown: &CancellationToken,
    ) -> anyhow::Result<Agent> {
        let (uplink, uplink_handle) = uplink::prepare(&config.uplink, &spool).await?;
        let exclusion = spool.exclusion().await?;
        let stored_alert = spool.alert().await?;
        let judged_by = uplink_handle.model.borrow().as_ref().map(|model| model.id);
        let settings = uplink_handle.settings.borrow().clone();
        let last_contact = uplink_handle.link.borrow().last_contact;
        let stale_s = config.silence.stale_s.0;
        let mut acquisition = Acquisition::new(&config.roles, stale_s, settings, exclusion);
        let is_recorded = |input: &InputConfig| matches!(input, InputConfig::File(_));
        if !config.inputs.values().any(is_recorded) {
            // The computer may have lost its time with its power.
            let known = last_contact.map_or(clock::now(), |contact| contact.max(clock::now()));
            acquisition.set_reference_time(known, Instant::now());
            if let Some(before) = spool.clock_checkpoint().await? {
                acquisition.restore_clock_checkpoint(before);
            }
        }
        let reports = spool.reports().await?;
        let unstored = Unstored {
            pending: spool.pending().await?,
            ..Unstored::default()
        };

        let outputs = Outputs::open(&config.output, shutdown).await?;
        let exclusion = watch::Sender::new(exclusion);
        let status = watch::Sender::new(Arc::new(Status::default()));
        let acknowledged = watch::Sender::new(None);
        let acknowledged_rx = acknowledged.subscribe();
        let served = PageState {
            spool: spool.clone(),
            status: status.subscribe(),
            exclusion: exclusion.clone(),
            acknowledged,
            upload_wakeup: uplink_handle.sealed.clone(),
        };
        let page = page::serve(config.page.as_ref(), served, shutdown).await?;
        let uplink = tokio::spawn(uplink.run(shutdown.clone()));
        if let Some(modem) = &config.modem {
            let modem = FileModem::open(modem.directory())
                .with_context(|| modem.directory().display().to_string())?;
            tokio::spawn(short_burst::run(spool.clone(), modem, shutdown.clone()));
        }

        let (tx, observations) = mpsc::channel(CHANNEL_CAPACITY);
        let mut inputs = Vec::new();
        for (name, input) in config.inputs {
            let stats = Arc::new(InputStats::default());
            inputs.push((name.clone(), stats.clone()));
            input::spawn(name.into(), input, tx.clone(), stats, shutdown.clone());
        }
        let page = page.map(|address| address.to_string());
        let output = outputs.tcp_address.map(|address| address.to_string());
        tracing::info!(page, output, inputs = inputs.len(), "ready");
        Ok(Agent {
            acquisition,
            last_contact,
            silence: config.silence,
            spool,
            spool_limit_bytes: config.spool_mb.bytes(),
            raw_log: RawLog::open(&config.data_dir, config.raw_log_mb.bytes()),
            plan: config.uplink.plan(),
            uplink_handle,
            reports,
            observations,
            inputs,
            outputs,
            interval: config.output.interval_s.duration(),
            exclusion,
            alert_monitor: AlertMonitor::new(config.alert, stored_alert, judged_by),
            stored_alert,
            withheld: false,
            acknowledged: acknowledged_rx,
            alarm: config.output.alarm_sentence.then(AlarmSentence::default),
            status,
            uplink,
            unstored,
            windows: Tally::default(),
        })
    }

    async fn run(mut self, shutdown: CancellationToken) {
        let mut second = interval(SECOND);
        let mut output = interval(self.interval);
        for ticks in [&mut second, &mut output] {
            ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        }
        let mut exclusion = self.exclusion.subscribe();
        loop {
            tokio::select! {
                () = shutdown.cancelled() => break,
                Some(observations) = self.observations.recv() => self.observe(&observations).await,
                _ = second.tick() => self.every_second().await,
                _ = output.tick() => self.send_heading(),
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
                Ok(()) = exclusion.changed() => {
                    let exclusion = *exclusion.borrow_and_update();
                    self.acquisition.sampler.set_exclusion(exclusion);
                }
                Ok(()) = self.acknowledged.changed() => {
                    let seen = *self.acknowledged.borrow_and_update();
                    if let Some(id) = seen {
                        self.alert_monitor.acknowledge(id);
                    }
                }
            }
        }
        self.stop().await;
    }

    /// Keeps what has settled, and lets the uplink finish its sentence.
    async fn stop(mut self) {
        self.observations.close();
        self.acquisition.sampler.finish();
        self.collect();
        self.store(Seal::Full).await;
        self.save_clock_checkpoint().await;
        self.raw_log.flush(Instant::now());
        if let Err(error) = self.uplink.await {
            tracing::error!(%error, "the uplink ended badly");
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
                let second = || Second::of(time, readings, stale, heard);
                self.raw_log.record(time, second, heard);
            }
        }
        self.update_alert();
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

    async fn every_second(&mut self) {
        self.update_alert();
        self.collect();
        let seal = self.seal_due();
        let unstored = &self.unstored;
        if seal == Seal::All || !unstored.samples.is_empty() || !unstored.alerts.is_empty() {
            self.store(seal).await;
        }
        self.save_alert().await;
        self.uplink_handle
            .ship_time
            .send_replace(self.acquisition.time());
        match self.spool.exclusion().await {
            Ok(exclusion) => {
                // The command line sets it there when it finds no page.
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
        self.status.send_replace(Arc::new(status));
    }

    /// Looks at what has settled since; the samples of an alert end with it.
    fn update_alert(&mut self) {
        let withdrawn = self.withdrawn();
        let model = self.uplink_handle.model.borrow();
        let card = ActiveCard {
            model: model.as_ref(),
            withdrawn: withdrawn.as_ref(),
        };
        let new_id = || uuid::Builder::from_random_bytes(rand::rng().random()).into_uuid();
        let settled = self.acquisition.sampler.take_settled();
        let revisions = settled
            .iter()
            .filter_map(|w| self.alert_monitor.observe(w, card, new_id));
        let mut revisions: Vec<ShipAlert> = revisions.collect();
        let now = self.acquisition.time();
        revisions.extend(now.and_then(|now| self.alert_monitor.update_card(card, now)));
        if revisions.is_empty() {
            return;
        }
        if let Some(record) = self.alert_monitor.record() {
            tracing::warn!("{}", record.status().summary);
        }
        self.acquisition.sampler.cut_sample();
        self.unstored.alerts.extend(revisions);
    }

    /// Keeps what only those aboard need to know of the alert.
    async fn save_alert(&mut self) {
        let Some(record) = self.alert_monitor.record().copied() else {
            return;
        };
        if self.stored_alert == Some(record) || !self.unstored.alerts.is_empty() {
            return;
        }
        match self.spool.save_alert(&record).await {
            Ok(()) => self.stored_alert = Some(record),
            Err(error) => tracing::error!(%error, "the alert cannot be stored"),
        }
    }

    fn collect(&mut self) {
        let tally = self.acquisition.sampler.take_tally();
        self.windows.plus(&tally);
        self.unstored.tally.plus(&tally);
        let samples = self.acquisition.sampler.take_samples();
        self.unstored.samples.extend(samples);
        if self.unstored.tally_since.is_none() {
            self.unstored.tally_since = self.acquisition.time();
        }
    }

    /// Why the model holds no more, by the shore's word or the officers'.
    fn withdrawn(&self) -> Option<CardWithdrawn> {
        let by_shore = self.uplink_handle.withdrawn.borrow().clone();
        by_shore.or_else(|| {
            let model = self.uplink_handle.model.borrow();
            let now = self.acquisition.time().unwrap_or_else(clock::now);
            card_invalidation::find_invalidation(model.as_ref()?, &self.reports, now)
        })
    }

    fn correct(&self) -> (CorrectedHeading, Vec<corrected_heading::CardRow>) {
        let withdrawn = self.withdrawn();
        let model = self.uplink_handle.model.borrow();
        let now = Instant::now();
        let readings = &self.acquisition.readings;
        let inputs = CorrectionInputs {
            compass: Latest::within(readings.compass, self.silence.stale_s.duration(), now),
            position: Latest::within(readings.position, POSITION_MAX_AGE, now),
            time: self.acquisition.time(),
            model: model.as_ref(),
            withdrawn: withdrawn.as_ref(),
            compass_suspected: self
                .alert_monitor
                .record()
                .is_some_and(AlertRecord::suspects_compass),
            withheld: self.withheld,
        };
        (
            corrected_heading::correct(inputs),
            corrected_heading::card(inputs),
        )
    }

    fn send_heading(&mut self) {
        let (corrected, _) = self.correct();
        self.withheld = corrected.is_withheld();
        let quality = self.model_status().map(|model| Quality {
            version: model.version,
            age_days: model.age_days.unwrap_or_default(),
        });
        let mut sentences = heading_sentences(&corrected, quality);
        if let Some(alarm) = &mut self.alarm {
            let due = alarm.due(self.alert_monitor.record(), Instant::now());
            sentences.extend(due.into_iter().flatten());
        }
        self.outputs.send(sentences);
    }

    fn model_status(&self) -> Option<ModelStatus> {
        let withdrawn = self.withdrawn();
        let model = self.uplink_handle.model.borrow();
        let model = model.as_ref()?;
        let now = self.acquisition.time().unwrap_or_else(clock::now);
        Some(ModelStatus {
            version: model.version,
            data_until: model.data_until,
            age_days: Some(now.seconds_since(model.data_until).max(0.0) / 86_400.0),
            withdrawn,
            replaces: model.replaces.clone(),
        })
    }

    async fn build_status(&self) -> Status {
        let now = Instant::now();
        let stale = self.silence.stale_s.duration();
        let readings = &self.acquisition.readings;
        let (heading, card) = self.correct();
        let mut status = offline_status(&self.spool).await.unwrap_or_default();
        status.running = true;
        status.ship_time = self.acquisition.time();
        status.heading = heading;
        status.card = card;
        status.alert = self.alert_monitor.record().map(AlertRecord::status);
        status.gyro_deg = Latest::within(readings.gyro, stale, now);
        status.satellite_deg = Latest::within(readings.satellite, stale, now);
        status.sog_kn = Latest::within(readings.sog_kn, stale, now);
        status.rate_of_turn_deg_min = Latest::within(readings.rate_of_turn_deg_min, stale, now);
        status.roll_deg = Latest::within(readings.roll_deg, stale, now);
        status.model = self.model_status();
        status.exclusion = *self.exclusion.borrow();
        status.windows = self.windows.by_name();
        let inputs = self.inputs.iter();
        status.inputs = inputs
            .map(|(name, stats)| InputReport::new(name, stats.status()))
            .collect();
        status.link = self.uplink_handle.link.borrow().clone();
        status.raw_log = self.raw_log.status();
        status.clock_problem = self.acquisition.clock_problem();
        status.storage_problem = self.unstored.problem.as_ref().map(|problem| {
            let waiting = self.unstored.samples.len();
            format!("samples cannot be stored: {problem}; {waiting} wait in memory")
        });
        status
    }
}
