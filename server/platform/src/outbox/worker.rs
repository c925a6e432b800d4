//! Outbox worker: sends the due deliveries, one after the other.

use super::delivery::Channel;
use super::queue::{self, Claimed};
use crate::app::App;
use metrics::counter;
use std::future::Future;
use std::time::Duration;
use tracing::{error, info, warn};

/// Interval at which the worker looks for deliveries without a notification.
const POLL_EVERY: Duration = Duration::from_secs(2);
/// Longest stored text of an error, characters.
const MAX_ERROR: usize = 300;

/// Carrier of messages to the receivers of one channel.
pub trait Carrier: Send + Sync {
    /// Channel served.
    const CHANNEL: Channel;

    /// Makes one attempt at a delivery.
    ///
    /// # Errors
    /// Fails when there was no response; the delivery is retried.
    fn carry(
        &self,
        app: &App,
        claimed: &Claimed,
    ) -> impl Future<Output = anyhow::Result<Attempt>> + Send;
}

/// Response of a receiver to an attempt, with its status.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Attempt {
    /// The message was accepted.
    Accepted(u16),
    /// The message was refused temporarily, with the reason.
    Deferred(u16, String),
    /// The message was refused permanently, with the reason.
    Refused(u16, String),
}

/// Outcome of one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sent {
    /// The receiver has the message.
    Delivered,
    /// The attempt failed and is retried.
    Failed,
    /// The delivery was given up.
    Dead,
}

/// Sends until the server stops.
pub async fn run<C: Carrier>(app: App, carrier: C) {
    while !app.stopping.is_cancelled() {
        match step(&app, &carrier).await {
            Ok(Some(_)) => continue,
            Ok(None) => {}
            Err(error) => error!(
                error = format!("{error:#}"),
                "messages cannot reach their queue"
            ),
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(POLL_EVERY) => {}
        }
    }
}

/// Makes one delivery, if one is due.
///
/// # Errors
/// Fails when the queue cannot be reached; a delivery that fails is not an error here.
pub async fn step<C: Carrier>(app: &App, carrier: &C) -> anyhow::Result<Option<Sent>> {
    let now = app.clock.now().into();
    let Some(claimed) = queue::claim(&app.db, C::CHANNEL, now).await? else {
        return Ok(None);
    };
    let attempt = carrier.carry(app, &claimed).await;
    let sent = note(app, &claimed, attempt).await?;
    let result = match sent {
        Sent::Delivered => "delivered",
        Sent::Failed => "failed",
        Sent::Dead => "dead",
    };
    let channel = C::CHANNEL.name();
    counter!("binnacle_delivery_tries_total", "channel" => channel, "result" => result)
        .increment(1);
    Ok(Some(sent))
}

async fn note(
    app: &App,
    claimed: &Claimed,
    attempt: anyhow::Result<Attempt>,
) -> anyhow::Result<Sent> {
    let now = app.clock.now().into();
    let receiver = claimed.receiver_id;
    let (status, problem, for_good) = match attempt {
        Ok(Attempt::Accepted(status)) => {
            queue::succeed(&app.db, claimed, status, now).await?;
            info!(%receiver, event = %claimed.id, "a message was delivered");
            return Ok(Sent::Delivered);
        }
        Ok(Attempt::Deferred(status, problem)) => (Some(status), problem, false),
        Ok(Attempt::Refused(status, problem)) => (Some(status), problem, true),
        Err(error) => (None, format!("{error:#}"), false),
    };
    let problem: String = problem.chars().take(MAX_ERROR).collect();
    let dead = for_good || queue::is_given_up(claimed, now);
    queue::fail(&app.db, claimed, status, &problem, dead, now).await?;
    if dead {
        warn!(%receiver, event = %claimed.id, problem, "a message was given up");
        return Ok(Sent::Dead);
    }
    info!(%receiver, event = %claimed.id, problem, "a message will be tried again");
    Ok(Sent::Failed)
}

impl Channel {
    fn name(self) -> &'static str {
        match self {
            Channel::Webhook => "webhook",
            Channel::Mail => "mail",
        }
    }
}
