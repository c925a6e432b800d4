//! An uplink made ready, and what it and the rest of the agent tell each other.

use super::{Backoff, Budget, LinkStatus, Publisher, ServerClient, Uplink};
use crate::config::UplinkConfig;
use crate::spool::Spool;
use binnacle_magnetics::time::Timestamp;
use binnacle_wire::messages::{CardWithdrawn, ModelDownlink, Settings};
use rand::SeedableRng;
use rand::rngs::StdRng;
use std::sync::Arc;
use tokio::sync::{Notify, watch};
use tokio::time::Instant;

/// The agent's side of it.
#[derive(Debug)]
pub(crate) struct UplinkHandle {
    /// The model to steer by.
    pub(crate) model: watch::Receiver<Option<ModelDownlink>>,
    /// Why that model holds no more.
    pub(crate) withdrawn: watch::Receiver<Option<CardWithdrawn>>,
    /// How to sample and send.
    pub(crate) settings: watch::Receiver<Settings>,
    /// How the link is.
    pub(crate) link: watch::Receiver<LinkStatus>,
    /// The ship's time, which earns the budget.
    pub(crate) ship_time: watch::Sender<Option<Timestamp>>,
    /// To be rung when a batch has been sealed or a report was written.
    pub(crate) sealed: Arc<Notify>,
    /// To be rung when evidence of an alert has been sealed.
    pub(crate) urgent: Arc<Notify>,
}

/// Goes on where the spool says that it was.
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
        budget: Budget::new(
            &plan,
            account,
            connection_policy.idle_timeout,
            Instant::now(),
        ),
        ship_time: uplink_handle.ship_time.subscribe(),
        publisher,
        keeps_connection: plan.keeps_connection(),
        exchange_open: false,
        reports_paused_until: None,
        sealed: uplink_handle.sealed.clone(),
        urgent: uplink_handle.urgent.clone(),
        rng: StdRng::from_rng(&mut rand::rng()),
    };
    Ok((uplink, uplink_handle))
}
