//! What the agent listens to. Each input is one task that delivers observations
//! into one bounded channel.
//!
//! What always holds:
//! - An input never gives up: what cannot be opened, or breaks off, is tried
//!   again with growing pauses. Only a file comes to an end.
//! - Nothing is buffered without bound. Where the sender can wait (TCP, serial,
//!   Signal K, files) it waits while the channel is full; datagrams cannot, and
//!   those that find no room are counted.
//! - Every line that is not used is counted by reason.

mod decode;
mod link;
mod pump;
mod readings;
mod signalk_delta;
mod stats;

mod file;
mod serial;
mod signalk;
mod tcp;
mod udp;

#[cfg(test)]
mod tests;

pub(crate) use file::replay;
pub(crate) use stats::{InputStats, InputStatus};

use crate::config::InputConfig;
use crate::instruments::Observation;
use link::{Backoff, End, Link};
use std::io;
use std::sync::Arc;
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

/// Starts reading an input until `shutdown`, the end of a file, or until nobody
/// takes the observations any more.
pub(crate) fn spawn(
    name: Arc<str>,
    config: InputConfig,
    tx: mpsc::Sender<Vec<Observation>>,
    stats: Arc<InputStats>,
    shutdown: CancellationToken,
) -> JoinHandle<()> {
    let link = Link::new(name, tx, stats);
    tokio::spawn(async move {
        shutdown.run_until_cancelled(run(&config, &link)).await;
        link.closed("stopped");
    })
}

async fn run(config: &InputConfig, link: &Link) {
    let mut backoff = Backoff::default();
    loop {
        let heard_before = link.stats.bytes();
        let why = match session(config, link).await {
            Ok(End::Finished) => return,
            Ok(End::Closed) => "the other side has closed the connection".to_owned(),
            Err(error) => error.to_string(),
        };
        if link.is_receiver_closed() {
            return;
        }
        link.closed(&why);
        if link.stats.bytes() > heard_before {
            backoff = Backoff::default();
        }
        tokio::time::sleep(backoff.next_pause()).await;
    }
}

async fn session(config: &InputConfig, link: &Link) -> io::Result<End> {
    match config {
        InputConfig::Serial(port) => serial::session(port, link).await,
        InputConfig::Tcp(address) => tcp::session(address, link).await,
        InputConfig::Udp(address) => udp::unicast(*address, link).await,
        InputConfig::Multicast(group) => udp::multicast(group, link).await,
        InputConfig::SignalK(url) => signalk::session(url, link).await,
        InputConfig::File(path) => file::session(path, link).await,
    }
}
