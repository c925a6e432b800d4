//! TCP servers of the output. No client can block the agent: one that does not read is dropped.
//!
//! A client that falls silent and comes back gets no old headings from the agent. The kernel
//! buffers little, and not for long, and the buffer of a dropped client is discarded. Data that its
//! own computer has already received cannot be recalled.

use crate::bridge_commands::read_commands;
use crate::line::Line;
use binnacle_nmea::sentence::Acn;
use socket2::SockRef;
use std::fmt;
use std::io;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncWrite, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{broadcast, mpsc};
use tokio::time::{sleep, timeout};
use tokio_util::sync::CancellationToken;

/// Intervals within which a client must take a line.
const WRITE_TIMEOUT_INTERVALS: f64 = 2.0;
/// Lower bound of the write timeout: a lost segment may be sent again.
const MIN_WRITE_TIMEOUT_S: f64 = 1.0;
/// Upper bound of the write timeout: an older heading is not for steering.
const MAX_WRITE_TIMEOUT_S: f64 = 10.0;
/// Send buffer of a client in the kernel: a few lines.
const CLIENT_BUFFER_BYTES: usize = 4096;

/// Server that sends the same lines to every client.
#[derive(Clone, Debug)]
pub(crate) struct TcpClients {
    pub(crate) lines: broadcast::Sender<Arc<[Line]>>,
    pub(crate) commands: mpsc::Sender<Acn>,
    pub(crate) write_timeout: Duration,
}

/// Reason for the end of a client's connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Lags,
    ReadsNothing,
    Silent,
    Closed,
    BufferUnlimited,
    AgentStops,
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            End::Lags => "it does not keep up",
            End::ReadsNothing => "it does not read",
            End::Silent => "it does not answer",
            End::Closed => "it closed the connection",
            End::BufferUnlimited => "its send buffer cannot be limited",
            End::AgentStops => "the agent stops",
        })
    }
}

/// Returns the time within which a client must take a line.
pub(crate) fn write_timeout(interval_s: f64) -> Duration {
    let seconds = WRITE_TIMEOUT_INTERVALS * interval_s;
    Duration::from_secs_f64(seconds.clamp(MIN_WRITE_TIMEOUT_S, MAX_WRITE_TIMEOUT_S))
}

/// Accepts clients until `shutdown`.
pub(crate) async fn accept(
    listener: TcpListener,
    clients: TcpClients,
    shutdown: CancellationToken,
) {
    while let Some(accepted) = shutdown.run_until_cancelled(listener.accept()).await {
        match accepted {
            Ok((stream, address)) => {
                let (clients, shutdown) = (clients.clone(), shutdown.clone());
                let lines = clients.lines.subscribe();
                tokio::spawn(async move {
                    let serving = serve(stream, lines, &clients.commands, clients.write_timeout);
                    let served = shutdown.run_until_cancelled(serving).await;
                    let reason = served.unwrap_or(End::AgentStops);
                    tracing::info!(%address, %reason, "a heading client disconnected");
                });
            }
            Err(error) => {
                tracing::warn!(%error, "a heading client could not be accepted");
                // Out of file handles, most likely: some will be closed in a while.
                sleep(Duration::from_secs(1)).await;
            }
        }
    }
}

/// Writes to one client until it fails, and reads its commands.
async fn serve(
    mut stream: TcpStream,
    lines: broadcast::Receiver<Arc<[Line]>>,
    commands: &mpsc::Sender<Acn>,
    write_timeout: Duration,
) -> End {
    if let Err(error) = bound_send_buffer(&stream, write_timeout) {
        tracing::warn!(%error, "a client's send buffer cannot be limited");
        return End::BufferUnlimited;
    }
    let (received, sent) = stream.split();
    let end = tokio::select! {
        end = write_lines(sent, lines, write_timeout) => end,
        never = read_commands(received, commands) => match never {},
    };
    if matches!(end, End::Lags | End::ReadsNothing) {
        discard_unsent(&stream);
    }
    end
}

async fn write_lines(
    mut client: impl AsyncWrite + Unpin,
    mut lines: broadcast::Receiver<Arc<[Line]>>,
    write_timeout: Duration,
) -> End {
    loop {
        let lines = match lines.recv().await {
            Ok(lines) => lines,
            Err(broadcast::error::RecvError::Lagged(_)) => return End::Lags,
            Err(broadcast::error::RecvError::Closed) => return End::AgentStops,
        };
        let text: Vec<u8> = lines.iter().flat_map(|line| &line.text).copied().collect();
        match timeout(write_timeout, client.write_all(&text)).await {
            Ok(Ok(())) => {}
            Ok(Err(error)) if error.kind() == io::ErrorKind::TimedOut => return End::Silent,
            Ok(Err(_)) => return End::Closed,
            Err(_) => return End::ReadsNothing,
        }
    }
}

/// Limits size and age of the data that the kernel buffers for a client, and sends each line at
/// once instead of collecting several.
fn bound_send_buffer(stream: &TcpStream, write_timeout: Duration) -> io::Result<()> {
    stream.set_nodelay(true)?;
    let socket = SockRef::from(stream);
    socket.set_send_buffer_size(CLIENT_BUFFER_BYTES)?;
    // On other systems the small buffer is the only limit.
    #[cfg(target_os = "linux")]
    socket.set_tcp_user_timeout(Some(write_timeout))?;
    #[cfg(not(target_os = "linux"))]
    let _ = write_timeout;
    Ok(())
}

/// Makes closing reset the connection; otherwise the kernel would go on delivering.
fn discard_unsent(stream: &TcpStream) {
    if let Err(error) = SockRef::from(stream).set_linger(Some(Duration::ZERO)) {
        tracing::debug!(%error, "a client's send buffer cannot be discarded");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::SentenceKind;
    use tokio::io::AsyncReadExt;

    /// A client with a small receive buffer, and the server's end of it.
    async fn small_client() -> (TcpStream, TcpStream) {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let socket = tokio::net::TcpSocket::new_v4().unwrap();
        socket.set_recv_buffer_size(4096).unwrap();
        let client = socket
            .connect(listener.local_addr().unwrap())
            .await
            .unwrap();
        (client, listener.accept().await.unwrap().0)
    }

    #[tokio::test]
    async fn what_waits_for_a_client_that_does_not_read_is_thrown_away() {
        let (mut client, stream) = small_client().await;
        let (lines, waiting) = broadcast::channel(1);
        let long = Line::single(SentenceKind::Hdt, vec![b'x'; 64 * 1024]);
        lines.send([long].into()).unwrap();
        drop(lines);
        let (commands, _taken) = mpsc::channel(1);
        let end = serve(stream, waiting, &commands, Duration::from_millis(50)).await;
        assert_eq!(end, End::ReadsNothing);
        let mut rest = Vec::new();
        let cut = client.read_to_end(&mut rest).await.unwrap_err();
        assert_eq!(cut.kind(), io::ErrorKind::ConnectionReset);
        assert!(rest.len() < 32 * 1024, "{} bytes were kept", rest.len());
    }

    #[cfg(target_os = "linux")]
    #[tokio::test]
    async fn the_kernel_keeps_little_and_not_for_long_and_sends_at_once() {
        let (_client, stream) = small_client().await;
        bound_send_buffer(&stream, write_timeout(1.0)).unwrap();
        assert!(stream.nodelay().unwrap());
        let socket = SockRef::from(&stream);
        // Linux reports twice the requested size.
        assert!(socket.send_buffer_size().unwrap() <= 2 * CLIENT_BUFFER_BYTES);
        let seconds = Duration::from_secs;
        assert_eq!(socket.tcp_user_timeout().unwrap(), Some(seconds(2)));
        assert_eq!(
            (write_timeout(0.05), write_timeout(3600.0)),
            (seconds(1), seconds(10))
        );
    }
}
