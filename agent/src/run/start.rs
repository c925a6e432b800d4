//! Start of the agent.

use super::{Agent, CHANNEL_CAPACITY, ServiceManager, Unstored};
use crate::acquisition::Acquisition;
use crate::alert::{AlarmSentence, AlertMonitor, DifferenceMonitor, InterferenceMonitor};
use crate::clock;
use crate::config::Config;
use crate::page::{self, PageState, PinGuard};
use crate::raw_log::RawLog;
use crate::sampler::Tally;
use crate::short_burst::{self, FileModem};
use crate::spool::Spool;
use crate::status::{Status, status_socket};
use crate::uplink;
use anyhow::Context;
use binnacle_compass::time::Timestamp;
use binnacle_input::config::AddressOwner;
use binnacle_input::{InputConfig, InputStats, SharedEnds};
use binnacle_instruments::OwnHeadings;
use binnacle_output::{AlertSentences, HeadingSentences, Outputs, SharedOutputs};
use std::collections::BTreeMap;
use std::sync::Arc;
use tokio::sync::{mpsc, watch};
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

impl Agent {
    /// Starts the inputs, the outputs, the page and the uplink.
    pub(super) async fn start(
        config: Config,
        spool: Spool,
        shutdown: &CancellationToken,
    ) -> anyhow::Result<Agent> {
        let (uplink, uplink_handle) = uplink::prepare(&config.uplink, &spool).await?;
        let exclusion = spool.exclusion().await?;
        let stored_alert = spool.alert().await?;
        let stored_difference = spool.heading_difference().await?;
        let judged_by = uplink_handle.model.borrow().as_ref().map(|model| model.id);
        let settings = uplink_handle.settings.borrow().clone();
        let last_contact = uplink_handle.link.borrow().last_contact;
        let (shared_outputs, mut shared_ends) = start_shared_outputs(&config, shutdown);
        let (roles, silence) = (&config.roles, &config.silence);
        let mut acquisition = Acquisition::new(roles, silence, settings, exclusion);
        acquisition.set_own_headings(OwnHeadings {
            sentences: config.output.headings(),
            devices: shared_outputs.own_devices(),
            labels: shared_outputs.own_labels(),
        });
        set_known_time_and_place(&mut acquisition, &config, &spool, last_contact).await?;
        let reports = spool.reports().await?;
        let unstored = Unstored {
            pending: spool.pending().await?,
            ..Unstored::default()
        };

        let (alert_command_tx, alert_commands) = mpsc::channel(CHANNEL_CAPACITY);
        let outputs = Outputs::open(&config.output, &alert_command_tx, shutdown).await?;
        let exclusion = watch::Sender::new(exclusion);
        let status = watch::Sender::new(Arc::new(Status::default()));
        let acknowledged = watch::Sender::new(None);
        let acknowledged_rx = acknowledged.subscribe();
        let pin = config.page.as_ref().and_then(|page| page.pin.clone());
        let served = PageState {
            spool: spool.clone(),
            status: status.subscribe(),
            exclusion: exclusion.clone(),
            acknowledged,
            upload_wakeup: uplink_handle.sealed.clone(),
            guard: Arc::new(PinGuard::new(pin, Instant::now())),
        };
        status_socket::serve(&config.data_dir, status.subscribe(), shutdown);
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
            let shared = shared_ends.remove(&name).unwrap_or_default();
            let (tx, shutdown) = (tx.clone(), shutdown.clone());
            binnacle_input::spawn(name.into(), input, shared, tx, stats, shutdown);
        }
        let page = page.map(|address| address.to_string());
        let output = outputs.tcp_address.map(|address| address.to_string());
        tracing::info!(page, output, inputs = inputs.len(), "ready");
        Ok(Agent {
            acquisition: Box::new(acquisition),
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
            alert_commands,
            sentences: HeadingSentences::new(&config.output),
            shared_outputs,
            exclusion,
            difference_monitor: DifferenceMonitor::new(
                &config.alert,
                stored_difference,
                Instant::now(),
            ),
            stored_difference,
            interference_monitor: InterferenceMonitor::default(),
            alert_monitor: AlertMonitor::new(config.alert, stored_alert, judged_by),
            stored_alert,
            offered_reading: None,
            withheld: false,
            acknowledged: acknowledged_rx,
            alert_sentences: config
                .output
                .alert_sentences
                .then(|| AlertSentences::new(config.output.talker)),
            alarm: config.output.alarm_sentence.then(AlarmSentence::default),
            status,
            service_manager: ServiceManager::default(),
            uplink,
            unstored,
            windows: Tally::default(),
            source_problems: Vec::new(),
        })
    }
}

/// Starts the outputs over inputs' connections. Returns also the ends for the inputs, by name.
fn start_shared_outputs(
    config: &Config,
    shutdown: &CancellationToken,
) -> (SharedOutputs, BTreeMap<String, SharedEnds>) {
    let owner = |input: &str| {
        let input = config.inputs.get(input);
        let owner = input.and_then(|input| input.n2k_address_owner().ok());
        // The configuration was checked for it.
        owner.unwrap_or(AddressOwner::Agent)
    };
    SharedOutputs::start(&config.output, owner, &config.data_dir, shutdown)
}

/// Tells the acquisition what is known of time and place, unless a recording is played: the computer may
/// have lost its own with its power.
async fn set_known_time_and_place(
    acquisition: &mut Acquisition,
    config: &Config,
    spool: &Spool,
    last_contact: Option<Timestamp>,
) -> anyhow::Result<()> {
    let is_recorded = |input: &InputConfig| matches!(input, InputConfig::File(_));
    if config.inputs.values().any(is_recorded) {
        return Ok(());
    }
    let known = last_contact.map_or(clock::now(), |contact| contact.max(clock::now()));
    acquisition.set_reference_time(known, Instant::now());
    if let Some(before) = spool.clock_checkpoint().await? {
        acquisition.restore_clock_checkpoint(before);
    }
    if let Some(saved) = spool.place_checkpoint().await? {
        acquisition.restore_place_checkpoint(saved, clock::now());
    }
    Ok(())
}
