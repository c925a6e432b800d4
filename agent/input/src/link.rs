//! Parts that all kinds of inputs share: delivery of observations, counts, connections and pauses.

use super::stats::InputStats;
use binnacle_observation::Observation;
use std::io;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::sync::mpsc;
use tokio::sync::mpsc::error::TrySendError;

/// Timeout of a connection attempt.
pub(crate) const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);

/// Receive buffer of a connection: a minute of a busy bridge. The system's default would hold tens
/// of megabytes, days of a voyage that is replayed fast, all lost if the agent is killed.
const RECEIVE_BUFFER_BYTES: usize = 128 * 1024;

const MIN_PAUSE: Duration = Duration::from_millis(100);
const MAX_PAUSE: Duration = Duration::from_secs(10);

/// Reason for the end of a session without an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// The file was read to its end.
    Finished,
    /// The other side closed the connection.
    Closed,
}

/// Connection of one input to the agent.
#[derive(Debug)]
pub(crate) struct Link {
    pub(crate) name: Arc<str>,
    pub(crate) stats: Arc<InputStats>,
    tx: mpsc::Sender<Vec<Observation>>,
}

impl Link {
    pub(crate) fn new(
        name: Arc<str>,
        tx: mpsc::Sender<Vec<Observation>>,
        stats: Arc<InputStats>,
    ) -> Link {
        Link { name, stats, tx }
    }

    pub(crate) fn opened(&self) {
        tracing::info!(input = %self.name, "input is open");
        self.stats.opened();
    }

    pub(crate) fn closed(&self, why: &str) {
        if self.stats.closed(why) {
            tracing::warn!(input = %self.name, why, "input is closed");
        }
    }

    /// Returns whether the receiver of the observations is gone.
    pub(crate) fn is_receiver_closed(&self) -> bool {
        self.tx.is_closed()
    }

    /// Delivers observations, waiting while the channel is full.
    pub(crate) async fn deliver(&self, observations: Vec<Observation>) -> io::Result<()> {
        if observations.is_empty() {
            return Ok(());
        }
        let count = observations.len();
        self.tx
            .send(observations)
            .await
            .map_err(|_| receiver_closed())?;
        self.stats.count_delivered(count);
        Ok(())
    }

    /// Delivers observations, or drops and counts them when the channel is full.
    pub(crate) fn offer(&self, observations: Vec<Observation>) -> io::Result<()> {
        if observations.is_empty() {
            return Ok(());
        }
        let count = observations.len();
        match self.tx.try_send(observations) {
            Ok(()) => self.stats.count_delivered(count),
            Err(TrySendError::Full(_)) => self.stats.count_dropped(count),
            Err(TrySendError::Closed(_)) => return Err(receiver_closed()),
        }
        Ok(())
    }
}

fn receiver_closed() -> io::Error {
    io::Error::new(
        io::ErrorKind::BrokenPipe,
        "the receiver of observations is closed",
    )
}

/// Connects, with a timeout, and with keep-alives for peers that vanish silently: their power may
/// fail at sea.
pub(crate) async fn connect(host_port: &str) -> io::Result<TcpStream> {
    let stream = tokio::time::timeout(CONNECT_TIMEOUT, TcpStream::connect(host_port))
        .await
        .map_err(|_| {
            io::Error::new(io::ErrorKind::TimedOut, "the connection attempt timed out")
        })??;
    let keepalive = socket2::TcpKeepalive::new()
        .with_time(Duration::from_secs(30))
        .with_interval(Duration::from_secs(10));
    let socket = socket2::SockRef::from(&stream);
    socket.set_tcp_keepalive(&keepalive)?;
    socket.set_recv_buffer_size(RECEIVE_BUFFER_BYTES)?;
    Ok(stream)
}

/// Pauses that double from a tenth of a second to ten seconds.
#[derive(Debug)]
pub(crate) struct Backoff(Duration);

impl Default for Backoff {
    fn default() -> Backoff {
        Backoff(MIN_PAUSE)
    }
}

impl Backoff {
    pub(crate) fn next_pause(&mut self) -> Duration {
        let pause = self.0;
        self.0 = (pause * 2).min(MAX_PAUSE);
        pause
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_double_up_to_ten_seconds() {
        let mut backoff = Backoff::default();
        let pauses: Vec<_> = (0..9).map(|_| backoff.next_pause().as_millis()).collect();
        assert_eq!(
            pauses,
            [100, 200, 400, 800, 1600, 3200, 6400, 10_000, 10_000]
        );
    }
}
