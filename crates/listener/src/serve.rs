//! Accepting connections, and ending them.

use crate::admission::Admission;
use crate::connection::{Shared, serve_connection};
use crate::limits::Limits;
use crate::stream::Stream;
use axum::Router;
use std::future::{Ready, ready};
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinSet;
use tokio::time::{Instant, sleep, timeout};
use tokio_util::sync::CancellationToken;
use tracing::{error, warn};

/// Pause after the system could not accept a connection, for want of files or memory.
const PAUSE: Duration = Duration::from_secs(1);
/// Least time between two warnings of the same matter.
const WARN_AGAIN: Duration = Duration::from_mins(1);

/// Handshake of plain TCP: none.
pub fn plain(stream: Stream) -> Ready<io::Result<Stream>> {
    ready(Ok(stream))
}

/// Serves a router on HTTP/1.1 and HTTP/2 until `stopping`, and then lets the requests in progress
/// finish. `handshake` makes of each TCP connection what HTTP is spoken on. Handlers find the
/// peer's address as `ConnectInfo<SocketAddr>`. Returns the number of connections that had to be
/// cut off.
pub async fn serve<H, F, Io>(
    listener: TcpListener,
    limits: Limits,
    handshake: H,
    router: Router,
    stopping: CancellationToken,
) -> usize
where
    H: FnOnce(Stream) -> F + Clone + Send + Sync + 'static,
    F: Future<Output = io::Result<Io>> + Send + 'static,
    Io: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let drain = limits.drain;
    let admission = Admission::new(limits.connections, limits.connections_per_network);
    let shared = Shared {
        limits: Arc::new(limits),
        router,
        handshake,
        stopping: stopping.clone(),
    };
    let mut connections = JoinSet::new();
    tokio::select! {
        () = stopping.cancelled() => {}
        () = accept(&listener, &admission, &shared, &mut connections) => {}
    }
    drop(listener);
    let finished = async { while connections.join_next().await.is_some() {} };
    if timeout(drain, finished).await.is_ok() {
        return 0;
    }
    let cut_off = connections.len();
    connections.shutdown().await;
    cut_off
}

/// Accepts connections for ever.
async fn accept<H, F, Io>(
    listener: &TcpListener,
    admission: &Admission,
    shared: &Shared<H>,
    connections: &mut JoinSet<()>,
) where
    H: FnOnce(Stream) -> F + Clone + Send + Sync + 'static,
    F: Future<Output = io::Result<Io>> + Send + 'static,
    Io: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let (mut full, mut crowded) = (Warning::default(), Warning::default());
    loop {
        if admission.is_full() && full.is_due() {
            let limit = shared.limits.connections;
            warn!(limit, "all connections are taken: further ones wait");
        }
        let place = admission.wait().await;
        let (stream, peer) = next_connection(listener).await;
        while connections.try_join_next().is_some() {}
        let Some(place) = admission.admit(place, peer.ip()) else {
            if crowded.is_due() {
                let limit = shared.limits.connections_per_network;
                warn!(%peer, limit, "a connection is refused: its network has too many");
            }
            continue;
        };
        connections.spawn(serve_connection(stream, peer, place, shared.clone()));
    }
}

/// Returns the next connection, however often the system fails to accept one.
async fn next_connection(listener: &TcpListener) -> (TcpStream, SocketAddr) {
    loop {
        match listener.accept().await {
            Ok(accepted) => return accepted,
            // It was gone before it was accepted.
            Err(error) if is_of_the_peer(&error) => {}
            Err(error) => {
                error!(%error, "no connection can be accepted for now");
                sleep(PAUSE).await;
            }
        }
    }
}

fn is_of_the_peer(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::ConnectionAborted
            | io::ErrorKind::ConnectionReset
            | io::ErrorKind::ConnectionRefused
            | io::ErrorKind::Interrupted
    )
}

/// A warning that is not repeated at each occasion.
#[derive(Debug, Default)]
struct Warning {
    last: Option<Instant>,
}

impl Warning {
    fn is_due(&mut self) -> bool {
        let now = Instant::now();
        let is_due = self.last.is_none_or(|last| now >= last + WARN_AGAIN);
        if is_due {
            self.last = Some(now);
        }
        is_due
    }
}
