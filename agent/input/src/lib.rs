//! Inputs. Each input is one task that delivers observations into one bounded channel.
//!
//! Invariants:
//! - An input never gives up: what cannot be opened, or breaks off, is retried with growing pauses.
//!   Only a file has an end.
//! - Buffers are bounded. Where the sender can wait (TCP, serial, Signal K, files) it waits while
//!   the channel is full. Datagrams cannot wait; those that do not fit are counted.
//! - Every line that is not used is counted by reason.

pub mod config;

mod decode;
mod link;
mod pump;
mod stats;

mod file;
mod n2k;
mod serial;
mod signalk;
mod signalk_access;
mod tcp;
mod udp;

#[cfg(test)]
mod tests;

pub use config::InputConfig;
pub use stats::{InputStats, InputStatus};

use binnacle_observation::Observation;
use link::{Backoff, End, Link};
use std::io;
use std::sync::Arc;
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

/// Reads an input until `shutdown`, until the end of a file, or until the receiver is gone.
pub fn spawn(
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
        InputConfig::SignalK(server) => signalk::session(server, link).await,
        InputConfig::SocketCan(interface) => n2k::socketcan(interface, link).await,
        InputConfig::Actisense(gateway) => n2k::actisense(gateway, link).await,
        InputConfig::Ydwg(gateway) => n2k::ydwg(gateway, link).await,
        InputConfig::File(path) => file::session(path, link).await,
    }
}
