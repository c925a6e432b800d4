//! Start of the uplink, and its handle for the rest of the agent.

use super::{Backoff, Budget, LinkStatus, Publisher, ReportPauses, ServerClient, Uplink};
use crate::config::UplinkConfig;
use crate::spool::Spool;
use binnacle_compass::time::Timestamp;
use binnacle_wire::messages::{CardWithdrawn, ModelDownlink, Settings};
use rand::SeedableRng;
use rand::rngs::StdRng;
use std::sync::Arc;
use tokio::sync::{Notify, watch};
use tokio::time::Instant;

/// Handle of the uplink for the rest of the agent.
#[derive(Debug)]
pub(crate) struct UplinkHandle {
    /// Current model.
    pub(crate) model: watch::Receiver<Option<ModelDownlink>>,
    /// Withdrawal of that model.
    pub(crate) withdrawn: watch::Receiver<Option<CardWithdrawn>>,
    /// Settings of sampling and upload.
    pub(crate) settings: watch::Receiver<Settings>,
    /// State of the link.
    pub(crate) link: watch::Receiver<LinkStatus>,
    /// GNSS time, by which the budget accrues.
    pub(crate) ship_time: watch::Sender<Option<Timestamp>>,
    /// To be notified when a batch has been sealed or a report was written.
    pub(crate) sealed: Arc<Notify>,
    /// To be notified when evidence of an alert has been sealed.
    pub(crate) urgent: Arc<Notify>,
}

/// Creates an uplink that continues with the state of the spool.
pub(crate) async fn prepare(
    config: &UplinkConfig,
    spool: &Spool,
) -> anyhow::Result<(Uplink, UplinkHandle)> {
    let publisher = Publisher {
        model: watch::Sender::new(spool.model().await?),
        withdrawn: watch::Sender::new(spool.card_withdrawn().await?),
        settings: watch::Sender::new(spool.settings().await?),
        link: watch::Sender::new(LinkStatus {
            last_contact: spool.last_contact().await?,
            ..LinkStatus::default()
        }),
    };
    let uplink_handle = UplinkHandle {
        model: publisher.model.subscribe(),
        withdrawn: publisher.withdrawn.subscribe(),
        settings: publisher.settings.subscribe(),
        link: publisher.link.subscribe(),
        ship_time: watch::Sender::new(None),
        sealed: Arc::default(),
        urgent: Arc::default(),
    };
    let account = spool.account().await?;
    let plan = config.plan();
    let connection_policy = config.connection_policy();
    let uplink = Uplink {
        spool: spool.clone(),
        token: spool.identity().await?.map(|identity| identity.token),
        refused_token: None,
        client: ServerClient::new(config.pinned_ca.as_deref(), &connection_policy)?,
        backoff: Backoff::new(
            config.retry_min_s.get_ref().duration(),
            config.retry_max_s.get_ref().duration(),
        ),
        poll: config.poll(),
        budget: Budget::new(&plan, account, Instant::now()),
        ship_time: uplink_handle.ship_time.subscribe(),
        publisher,
        keeps_connection: plan.keeps_connection(),
        exchange_open: false,
        report_pauses: ReportPauses::default(),
        sealed: uplink_handle.sealed.clone(),
        urgent: uplink_handle.urgent.clone(),
        rng: StdRng::from_rng(&mut rand::rng()),
    };
    Ok((uplink, uplink_handle))
}
