//! The running agent: inputs into the ship, samples into the spool, the
//! corrected heading out, once around per observation, second and interval.
//!
//! One task owns the ship; nothing is locked. When the disk is slow, this task
//! waits, its channel fills, and the inputs wait in turn: a recording that is
//! played fast is throttled and never lost.

use crate::clock;
use crate::config::{Config, SilenceConfig};
use crate::corrected::{self, Corrected, Ingredients};
use crate::hold::Hold;
use crate::input::{self, InputStats};
use crate::observation::Observation;
use crate::output::Outputs;
use crate::page::{self, Page};
use crate::sampler::Tally;
use crate::sentences::{Quality, sentences};
use crate::ship::{Latest, Ship};
use crate::spool::{Pending, Seal, Spool};
use crate::status::{InputReport, ModelStatus, Status};
use crate::uplink::{Backoff, LinkState, LinkStatus, Shore, Tell, Uplink};
use anyhow::Context;
use binnacle_magnetics::sample::Sample;
use binnacle_magnetics::time::Timestamp;
use binnacle_wire::messages::{CardWithdrawn, ModelDownlink, Settings};
use rand::SeedableRng;
use rand::rngs::StdRng;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::{Notify, mpsc, watch};
use tokio::time::{Instant, MissedTickBehavior, interval};
use tokio_util::sync::CancellationToken;

/// Samples are written to the spool when there are so many, or after a second.
pub(crate) const SAMPLES_PER_COMMIT: usize = 64;
/// Deliveries of observations that may wait: what is here dies with the agent.
const CHANNEL: usize = 8;
const SECOND: Duration = Duration::from_secs(1);
/// Variation at twenty knots changes by less than a tenth of a degree meanwhile.
const POSITION_SERVES: Duration = Duration::from_mins(10);
/// Windows that were only refused are reported this often, by ship time.
const TALLY_ALONE_S: f64 = 86_400.0;
/// If the disk takes nothing, so many samples are kept in memory.
const MOST_UNSTORED: usize = 20_000;

/// Runs until `shutdown`; everything settled is in the spool then.
pub(crate) async fn run(config: Config, shutdown: CancellationToken) -> anyhow::Result<()> {
    let (spool, _alone) = Spool::open_for_agent(&config.data_dir).await?;
    let agent = Agent::start(config, spool.clone(), &shutdown).await?;
    agent.run(shutdown).await;
    spool.set_page(None).await.ok();
    spool.close().await;
    Ok(())
}

struct Agent {
    ship: Ship,
    silence: SilenceConfig,
    spool: Spool,
    observations: mpsc::Receiver<Vec<Observation>>,
    inputs: Vec<(String, Arc<InputStats>)>,
    outputs: Outputs,
    interval: Duration,
    model: watch::Receiver<Option<ModelDownlink>>,
    withdrawn: watch::Receiver<Option<CardWithdrawn>>,
    settings: watch::Receiver<Settings>,
    link: watch::Receiver<LinkStatus>,
    hold: watch::Sender<Option<Hold>>,
    status: watch::Sender<Arc<Status>>,
    sealed: Arc<Notify>,
    uplink: tokio::task::JoinHandle<()>,
    unstored: Unstored,
    windows: Tally,
}

/// What the sampler has finished and the spool does not have yet.
#[derive(Debug, Default)]
struct Unstored {
    samples: Vec<Sample>,
    tally: Tally,
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
        let settings = spool.settings().await?;
        let model = spool.model().await?;
        let hold = spool.hold().await?;
        let ship = Ship::new(
            &config.roles,
            config.silence.stale_s.0,
            settings.clone(),
            hold,
        );
        let unstored = Unstored {
            pending: spool.pending().await?,
            ..Unstored::default()
        };

        let outputs = Outputs::open(&config.output, shutdown).await?;
        let hold = watch::Sender::new(hold);
        let status = watch::Sender::new(Arc::new(Status::default()));
        let sealed = Arc::new(Notify::new());
        let page = serve_page(&config, &spool, &status, &hold, &sealed, shutdown).await?;
        let model = watch::Sender::new(model);
        let withdrawn = watch::Sender::new(spool.card_withdrawn().await?);
        let withdrawn_rx = withdrawn.subscribe();
        let settings = watch::Sender::new(settings);
        let link = watch::Sender::new(LinkStatus {
            last_contact: spool.last_contact().await?,
            ..LinkStatus::default()
        });
        let (model_rx, settings_rx, link_rx) =
            (model.subscribe(), settings.subscribe(), link.subscribe());
        let uplink = Uplink {
            spool: spool.clone(),
            token: spool.identity().await?.map(|identity| identity.token),
            shore: Shore::new(config.uplink.pinned_ca.as_deref())?,
            backoff: Backoff::new(
                config.uplink.retry_min_s.get_ref().duration(),
                config.uplink.retry_max_s.get_ref().duration(),
            ),
            poll: config.uplink.poll_s.duration(),
            tell: Tell {
                model,
                withdrawn,
                settings,
                link,
            },
            no_reports_before: None,
            sealed: sealed.clone(),
            rng: StdRng::from_rng(&mut rand::rng()),
        };
        let uplink = tokio::spawn(uplink.run(shutdown.clone()));

        let (tx, observations) = mpsc::channel(CHANNEL);
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
            ship,
            silence: config.silence,
            spool,
            observations,
            inputs,
            outputs,
            interval: config.output.interval_s.duration(),
            model: model_rx,
            withdrawn: withdrawn_rx,
            settings: settings_rx,
            link: link_rx,
            hold,
            status,
            sealed,
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
        let mut hold = self.hold.subscribe();
        loop {
            tokio::select! {
                () = shutdown.cancelled() => break,
                Some(observations) = self.observations.recv() => self.observe(&observations).await,
                _ = second.tick() => self.every_second().await,
                _ = output.tick() => self.send_heading(),
                Ok(()) = self.settings.changed() => {
                    let settings = self.settings.borrow_and_update().clone();
                    self.ship.sampler.set_settings(settings);
                }
                Ok(()) = hold.changed() => {
                    let hold = *hold.borrow_and_update();
                    self.ship.sampler.set_hold(hold);
                }
            }
        }
        self.stop().await;
    }

    /// Keeps what has settled, and lets the uplink finish its sentence.
    async fn stop(mut self) {
        self.observations.close();
        self.ship.sampler.finish();
        self.collect();
        self.store(Seal::Full).await;
        if let Err(error) = self.uplink.await {
            tracing::error!(%error, "the uplink ended badly");
        }
        tracing::info!("stopped");
    }

    async fn observe(&mut self, observations: &[Observation]) {
        let heard = Instant::now();
        for observation in observations {
            self.ship.observe(observation, heard);
        }
        if !self.ship.sampler.has_samples() {
            return;
        }
        self.collect();
        let seal = self.seal_due();
        if seal == Seal::All || self.unstored.samples.len() >= SAMPLES_PER_COMMIT {
            self.store(seal).await;
        }
    }

    async fn every_second(&mut self) {
        self.collect();
        let seal = self.seal_due();
        if seal == Seal::All || !self.unstored.samples.is_empty() {
            self.store(seal).await;
        }
        match self.spool.hold().await {
            Ok(hold) => {
                // The command line sets it there when it finds no page.
                self.hold
                    .send_if_modified(|known| std::mem::replace(known, hold) != hold);
            }
            Err(error) => tracing::error!(%error, "the spool cannot be read"),
        }
        let status = self.take_stock().await;
        self.status.send_replace(Arc::new(status));
    }

    fn collect(&mut self) {
        let tally = self.ship.sampler.take_tally();
        self.windows.plus(&tally);
        self.unstored.tally.plus(&tally);
        let samples = self.ship.sampler.take_samples();
        self.unstored.samples.extend(samples);
        if self.unstored.tally_since.is_none() {
            self.unstored.tally_since = self.ship.time();
        }
    }

    /// By the ship's time; after a jump of her clock, whichever way.
    fn seal_due(&self) -> Seal {
        let Some(now) = self.ship.time() else {
            return Seal::Full;
        };
        let seal_s = f64::from(self.settings.borrow().seal_s);
        let older = |since: Option<Timestamp>, seconds: f64| {
            since.is_some_and(|since| now.seconds_since(since).abs() >= seconds)
        };
        let first = self.unstored.samples.first().map(|sample| sample.time);
        let due = older(self.unstored.pending.since, seal_s)
            || older(first, seal_s)
            || older(self.unstored.tally_since, TALLY_ALONE_S.max(seal_s));
        if due { Seal::All } else { Seal::Full }
    }

    async fn store(&mut self, seal: Seal) {
        let unstored = &mut self.unstored;
        let tally = unstored.tally.by_name();
        match self.spool.store(&unstored.samples, &tally, seal).await {
            Ok((pending, sealed)) => {
                unstored.samples.clear();
                unstored.tally = Tally::default();
                unstored.pending = pending;
                if seal == Seal::All {
                    unstored.tally_since = self.ship.time();
                }
                if sealed > 0 {
                    self.sealed.notify_one();
                }
            }
            Err(error) => {
                tracing::error!(%error, waiting = unstored.samples.len(), "samples cannot be stored");
                let excess = unstored.samples.len().saturating_sub(MOST_UNSTORED);
                unstored.samples.drain(..excess);
            }
        }
    }

    fn correct(&self) -> (Corrected, Vec<corrected::CardRow>) {
        let model = self.model.borrow();
        let withdrawn = self.withdrawn.borrow();
        let now = Instant::now();
        let readings = &self.ship.readings;
        let from = Ingredients {
            compass: Latest::within(readings.compass, self.silence.stale_s.duration(), now),
            position: Latest::within(readings.position, POSITION_SERVES, now),
            time: self.ship.time(),
            model: model.as_ref(),
            withdrawn: withdrawn.as_ref(),
        };
        (corrected::correct(from), corrected::card(from))
    }

    fn send_heading(&self) {
        let (corrected, _) = self.correct();
        let quality = self.model_status().map(|model| Quality {
            version: model.version,
            age_days: model.age_days.unwrap_or_default(),
        });
        self.outputs.send(sentences(&corrected, quality));
    }

    fn model_status(&self) -> Option<ModelStatus> {
        let model = self.model.borrow();
        let model = model.as_ref()?;
        let now = self.ship.time().unwrap_or_else(clock::now);
        Some(ModelStatus {
            version: model.version,
            data_until: model.data_until,
            age_days: Some(now.seconds_since(model.data_until).max(0.0) / 86_400.0),
            withdrawn: self.withdrawn.borrow().clone(),
            replaces: model.replaces.clone(),
        })
    }

    async fn take_stock(&self) -> Status {
        let now = Instant::now();
        let stale = self.silence.stale_s.duration();
        let readings = &self.ship.readings;
        let (heading, card) = self.correct();
        let mut status = offline_status(&self.spool).await.unwrap_or_default();
        status.running = true;
        status.ship_time = self.ship.time();
        status.heading = heading;
        status.card = card;
        status.gyro_deg = Latest::within(readings.gyro, stale, now);
        status.satellite_deg = Latest::within(readings.satellite, stale, now);
        status.sog_kn = Latest::within(readings.sog_kn, stale, now);
        status.rate_of_turn_deg_min = Latest::within(readings.rate_of_turn_deg_min, stale, now);
        status.roll_deg = Latest::within(readings.roll_deg, stale, now);
        status.model = self.model_status();
        status.hold = *self.hold.borrow();
        status.windows = self.windows.by_name();
        let inputs = self.inputs.iter();
        status.inputs = inputs
            .map(|(name, stats)| InputReport::new(name, stats.status()))
            .collect();
        status.link = self.link.borrow().clone();
        status
    }
}

async fn serve_page(
    config: &Config,
    spool: &Spool,
    status: &watch::Sender<Arc<Status>>,
    hold: &watch::Sender<Option<Hold>>,
    news: &Arc<Notify>,
    shutdown: &CancellationToken,
) -> anyhow::Result<Option<std::net::SocketAddr>> {
    let Some(page) = &config.page else {
        spool.set_page(None).await?;
        return Ok(None);
    };
    let listener = TcpListener::bind(page.listen)
        .await
        .with_context(|| format!("page.listen {}: cannot listen", page.listen))?;
    let address = listener.local_addr()?;
    spool.set_page(Some(address)).await?;
    let router = page::router(Page {
        spool: spool.clone(),
        status: status.subscribe(),
        hold: hold.clone(),
        news: news.clone(),
    });
    let stopped = shutdown.clone().cancelled_owned();
    tokio::spawn(async move {
        let served = axum::serve(listener, router)
            .with_graceful_shutdown(stopped)
            .await;
        if let Err(error) = served {
            tracing::error!(%error, "the local page stopped");
        }
    });
    Ok(Some(address))
}

/// What the spool alone can tell.
pub(crate) async fn offline_status(spool: &Spool) -> sqlx::Result<Status> {
    let identity = spool.identity().await?;
    let last_contact = spool.last_contact().await?;
    let state = if identity.is_some() {
        LinkState::Down
    } else {
        LinkState::NotEnrolled
    };
    let withdrawn = spool.card_withdrawn().await?;
    Ok(Status {
        agent_version: env!("CARGO_PKG_VERSION").to_owned(),
        vessel_name: identity
            .as_ref()
            .map(|identity| identity.vessel_name.clone()),
        compass_name: identity.map(|identity| identity.compass_name),
        model: spool.model().await?.map(|model| ModelStatus {
            version: model.version,
            data_until: model.data_until,
            age_days: None,
            withdrawn,
            replaces: model.replaces,
        }),
        hold: spool.hold().await?,
        link: LinkStatus {
            state,
            problem: None,
            last_contact,
        },
        spool: spool.standing().await?,
        ..Status::default()
    })
}
