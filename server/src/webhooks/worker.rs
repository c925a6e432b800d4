//! Sends what is due, one delivery after the other.

use super::deliveries::{self, Claimed};
use super::send::Sender;
use crate::app::App;
use metrics::counter;
use std::time::Duration;
use tracing::{error, info, warn};

/// How often to look for deliveries that nobody was told of.
const LOOK_EVERY: Duration = Duration::from_secs(2);
/// Longest text that is kept of an error, characters.
const MAX_ERROR: usize = 300;

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sent {
    /// The receiver has it.
    Delivered,
    /// It will be tried again.
    Failed,
    /// It was given up.
    Dead,
}

/// Sends until the server stops.
pub async fn run(app: App, sender: Sender) {
    while !app.stopping.is_cancelled() {
        match step(&app, &sender).await {
            Ok(Some(_)) => continue,
            Ok(None) => {}
            Err(error) => error!(
                error = format!("{error:#}"),
                "webhooks cannot reach their queue"
            ),
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(LOOK_EVERY) => {}
        }
    }
}

/// Makes one delivery, if one is due.
///
/// # Errors
/// When the queue cannot be reached; a delivery that fails is not an error here.
pub async fn step(app: &App, sender: &Sender) -> anyhow::Result<Option<Sent>> {
    let Some(claimed) = deliveries::claim(&app.db, app.clock.now().into()).await? else {
        return Ok(None);
    };
    let sent = send(app, sender, &claimed).await?;
    let result = match sent {
        Sent::Delivered => "delivered",
        Sent::Failed => "failed",
        Sent::Dead => "dead",
    };
    counter!("binnacle_webhook_tries_total", "result" => result).increment(1);
    Ok(Some(sent))
}

async fn send(app: &App, sender: &Sender, claimed: &Claimed) -> anyhow::Result<Sent> {
    let seconds = app.clock.now().micros() / 1_000_000;
    let body = claimed.body.clone();
    let answer = sender
        .send(&claimed.url, &claimed.secret, seconds, body)
        .await;
    let now = app.clock.now().into();
    let webhook = claimed.webhook_id;
    let (status, problem) = match answer {
        Ok(status @ 200..=299) => {
            deliveries::succeed(&app.db, claimed, status, now).await?;
            info!(%webhook, event = %claimed.id, "a webhook was told");
            return Ok(Sent::Delivered);
        }
        Ok(status) => (Some(status), format!("answered with status {status}")),
        Err(error) => (None, format!("{error:#}").chars().take(MAX_ERROR).collect()),
    };
    if deliveries::fail(&app.db, claimed, status, &problem, now).await? {
        warn!(%webhook, event = %claimed.id, problem, "a webhook's delivery was given up");
        return Ok(Sent::Dead);
    }
    info!(%webhook, event = %claimed.id, problem, "a webhook will be tried again");
    Ok(Sent::Failed)
}
