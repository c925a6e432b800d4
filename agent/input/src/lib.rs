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
mod port;
mod pump;
mod stats;

mod can;
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
pub use port::{Port, PortEnd, PortEvent};
pub use stats::{InputStats, InputStatus};

use binnacle_nmea::n2k::Message;
use binnacle_observation::Observation;
use link::{Backoff, End, Link};
use std::io;
use std::sync::Arc;
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

/// Inputs' ends of the connections that outputs share.
#[derive(Debug, Default)]
pub struct SharedEnds {
    /// End for messages of an NMEA 2000 bus.
    pub bus: Option<PortEnd<Message>>,
    /// End for deltas to a Signal K server.
    pub deltas: Option<PortEnd<String>>,
}

/// Reads an input until `shutdown`, until the end of a file, or until the receiver is gone. An
/// output may share its connection.
pub fn spawn(
    name: Arc<str>,
    config: InputConfig,
    mut shared: SharedEnds,
    tx: mpsc::Sender<Vec<Observation>>,
    stats: Arc<InputStats>,
    shutdown: CancellationToken,
) -> JoinHandle<()> {
    let link = Link::new(name, tx, stats);
    tokio::spawn(async move {
        shutdown
            .run_until_cancelled(run(&config, &mut shared, &link))
            .await;
        link.closed("stopped");
    })
}

async fn run(config: &InputConfig, shared: &mut SharedEnds, link: &Link) {
    let mut backoff = Backoff::default();
    loop {
        let heard_before = link.stats.bytes();
        let why = match session(config, shared, link).await {
            Ok(End::Finished) => return,
            Ok(End::Closed) => "the other side has closed the connection".to_owned(),
            Err(error) => error.to_string(),
        };
        if link.is_receiver_closed() {
            return;
        }
        link.closed(&why);
        shared.closed().await;
        if link.stats.bytes() > heard_before {
            backoff = Backoff::default();
        }
        tokio::time::sleep(backoff.next_pause()).await;
    }
}

impl SharedEnds {
    async fn closed(&self) {
        if let Some(end) = &self.bus {
            end.closed().await;
        }
        if let Some(end) = &self.deltas {
            end.closed().await;
        }
    }
}

async fn session(config: &InputConfig, shared: &mut SharedEnds, link: &Link) -> io::Result<End> {
    let SharedEnds { bus, deltas } = shared;
    match config {
        InputConfig::Serial(port) => serial::session(port, link).await,
        InputConfig::Tcp(address) => tcp::session(address, link).await,
        InputConfig::Udp(address) => udp::unicast(*address, link).await,
        InputConfig::Multicast(group) => udp::multicast(group, link).await,
        InputConfig::SignalK(server) => signalk::session(server, deltas, link).await,
        InputConfig::SocketCan(interface) => n2k::socketcan(interface, bus, link).await,
        InputConfig::Actisense(gateway) => n2k::actisense(gateway, bus, link).await,
        InputConfig::Ydwg(gateway) => n2k::ydwg(gateway, bus, link).await,
        InputConfig::File(path) => file::session(path, link).await,
    }
}
