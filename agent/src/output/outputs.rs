//! Sinks of the corrected heading: a TCP server, UDP datagrams, a serial port.
//!
//! No receiver can block the agent. A TCP client that does not read is dropped, and a serial port
//! that is busy or gone misses a line.
//!
//! A client that falls silent and comes back gets no old headings from the agent. The kernel
//! buffers little, and not for long, and the buffer of a dropped client is discarded. Data that its
//! own computer has already received cannot be recalled.

use crate::config::{OutputConfig, SerialConfig};
use anyhow::Context;
use socket2::SockRef;
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::AsyncWriteExt;
use tokio::net::{TcpListener, TcpStream, UdpSocket};
use tokio::sync::{broadcast, mpsc};
use tokio::time::{sleep, timeout};
use tokio_serial::SerialPortBuilderExt;
use tokio_util::sync::CancellationToken;

/// Outputs that a client may lag behind before it is dropped.
const MAX_CLIENT_LAG: usize = 16;
/// Intervals within which a client must take a line.
const WRITE_TIMEOUT_INTERVALS: f64 = 2.0;
/// Lower bound of the write timeout: a lost segment may be sent again.
const MIN_WRITE_TIMEOUT_S: f64 = 1.0;
/// Upper bound of the write timeout: an older heading is not for steering.
const MAX_WRITE_TIMEOUT_S: f64 = 10.0;
/// Send buffer of a client in the kernel: a few lines.
const CLIENT_BUFFER_BYTES: usize = 4096;
/// Pause before a failed serial port is opened again.
const SERIAL_RETRY: Duration = Duration::from_secs(5);

/// Open outputs.
#[derive(Debug)]
pub(crate) struct Outputs {
    clients: Vec<broadcast::Sender<Arc<[u8]>>>,
    udp: Vec<(UdpSocket, SocketAddr)>,
    serial: Vec<mpsc::Sender<Arc<[u8]>>>,
    /// Address of the first TCP server.
    pub(crate) tcp_address: Option<SocketAddr>,
}

impl Outputs {
    /// Opens the configured outputs, which run until `shutdown`.
    pub(crate) async fn open(
        config: &OutputConfig,
        shutdown: &CancellationToken,
    ) -> anyhow::Result<Outputs> {
        let mut outputs = Outputs {
            clients: Vec::new(),
            udp: Vec::new(),
            serial: Vec::new(),
            tcp_address: None,
        };
        for &address in &config.tcp_server {
            let listener = TcpListener::bind(address)
                .await
                .with_context(|| format!("output.tcp_server {address}: cannot listen"))?;
            let bound = listener.local_addr()?;
            outputs.tcp_address.get_or_insert(bound);
            let (clients, _) = broadcast::channel(MAX_CLIENT_LAG);
            outputs.clients.push(clients.clone());
            let write_timeout = write_timeout(config.interval_s.0);
            tokio::spawn(accept(listener, clients, write_timeout, shutdown.clone()));
        }
        for &target in &config.udp {
            outputs.udp.push((udp_socket(target).await?, target));
        }
        for serial in &config.serial {
            let (lines, waiting) = mpsc::channel(1);
            outputs.serial.push(lines);
            tokio::spawn(write_serial(serial.clone(), waiting, shutdown.clone()));
        }
        Ok(outputs)
    }

    /// Sends to all receivers without waiting.
    pub(crate) fn send(&self, sentences: Vec<u8>) {
        let sentences: Arc<[u8]> = sentences.into();
        for (socket, target) in &self.udp {
            if let Err(error) = socket.try_send_to(&sentences, *target) {
                tracing::debug!(%error, %target, "a datagram was not sent");
            }
        }
        for serial in &self.serial {
            // Full: the port is slower than the interval, or gone.
            serial.try_send(sentences.clone()).ok();
        }
        for clients in &self.clients {
            // An error only means that no client is connected.
            clients.send(sentences.clone()).ok();
        }
    }
}

async fn udp_socket(target: SocketAddr) -> anyhow::Result<UdpSocket> {
    let any = if target.is_ipv4() {
        "0.0.0.0:0"
    } else {
        "[::]:0"
    };
    let socket = UdpSocket::bind(any)
        .await
        .with_context(|| format!("output.udp {target}: cannot open a socket"))?;
    socket
        .set_broadcast(true)
        .with_context(|| format!("output.udp {target}: cannot broadcast"))?;
    Ok(socket)
}

fn write_timeout(interval_s: f64) -> Duration {
    let seconds = WRITE_TIMEOUT_INTERVALS * interval_s;
    Duration::from_secs_f64(seconds.clamp(MIN_WRITE_TIMEOUT_S, MAX_WRITE_TIMEOUT_S))
}

async fn accept(
    listener: TcpListener,
    clients: broadcast::Sender<Arc<[u8]>>,
    write_timeout: Duration,
    shutdown: CancellationToken,
) {
    while let Some(accepted) = shutdown.run_until_cancelled(listener.accept()).await {
        match accepted {
            Ok((stream, address)) => {
                let lines = clients.subscribe();
                let shutdown = shutdown.clone();
                tokio::spawn(async move {
                    let serving = serve(stream, lines, write_timeout);
                    let served = shutdown.run_until_cancelled(serving).await;
                    let reason = served.unwrap_or("the agent stops");
                    tracing::info!(%address, reason, "a heading client disconnected");
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

/// Writes to one client until it fails. Returns the reason.
async fn serve(
    mut stream: TcpStream,
    mut lines: broadcast::Receiver<Arc<[u8]>>,
    write_timeout: Duration,
) -> &'static str {
    if let Err(error) = bound_send_buffer(&stream, write_timeout) {
        tracing::warn!(%error, "a client's send buffer cannot be limited");
        return "its send buffer cannot be limited";
    }
    loop {
        let line = match lines.recv().await {
            Ok(line) => line,
            Err(broadcast::error::RecvError::Lagged(_)) => {
                discard_unsent(&stream);
                return "it does not keep up";
            }
            Err(broadcast::error::RecvError::Closed) => return "the agent stops",
        };
        match timeout(write_timeout, stream.write_all(&line)).await {
            Ok(Ok(())) => {}
            Ok(Err(error)) if error.kind() == io::ErrorKind::TimedOut => {
                return "it does not answer";
            }
            Ok(Err(_)) => return "it closed the connection",
            Err(_) => {
                discard_unsent(&stream);
                return "it does not read";
            }
        }
    }
}

/// Limits size and age of the data that the kernel buffers for a client.
fn bound_send_buffer(stream: &TcpStream, write_timeout: Duration) -> io::Result<()> {
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

async fn write_serial(
    config: SerialConfig,
    mut lines: mpsc::Receiver<Arc<[u8]>>,
    shutdown: CancellationToken,
) {
    let mut reported = false;
    loop {
        let result = shutdown
            .run_until_cancelled(write_open_serial(&config, &mut lines))
            .await;
        let Some(Err(error)) = result else { return };
        if !reported {
            tracing::warn!(path = config.path, %error, "the serial output failed, retrying");
            reported = true;
        }
        if shutdown
            .run_until_cancelled(sleep(SERIAL_RETRY))
            .await
            .is_none()
        {
            return;
        }
    }
}

async fn write_open_serial(
    config: &SerialConfig,
    lines: &mut mpsc::Receiver<Arc<[u8]>>,
) -> std::io::Result<()> {
    let mut port = tokio_serial::new(&config.path, config.baud).open_native_async()?;
    while let Some(line) = lines.recv().await {
        port.write_all(&line).await?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::io::{AsyncBufReadExt, AsyncReadExt, BufReader};

    async fn server() -> (Outputs, SocketAddr, CancellationToken) {
        let shutdown = CancellationToken::new();
        let config = OutputConfig {
            tcp_server: vec!["127.0.0.1:0".parse().unwrap()],
            ..OutputConfig::default()
        };
        let outputs = Outputs::open(&config, &shutdown).await.unwrap();
        let address = outputs.tcp_address.unwrap();
        (outputs, address, shutdown)
    }

    /// Waits until the given number of clients is connected.
    async fn connected(outputs: &Outputs, clients: usize) {
        while outputs.clients[0].receiver_count() < clients {
            tokio::task::yield_now().await;
        }
    }

    #[tokio::test]
    async fn every_client_hears_every_line() {
        let (outputs, address, _shutdown) = server().await;
        let first = TcpStream::connect(address).await.unwrap();
        let second = TcpStream::connect(address).await.unwrap();
        connected(&outputs, 2).await;
        for line in ["one\r\n", "two\r\n"] {
            outputs.send(line.into());
        }
        for client in [first, second] {
            let mut lines = BufReader::new(client).lines();
            assert_eq!(lines.next_line().await.unwrap().unwrap(), "one");
            assert_eq!(lines.next_line().await.unwrap().unwrap(), "two");
        }
    }

    #[tokio::test]
    async fn a_client_that_does_not_keep_up_is_dropped_and_the_others_are_not() {
        let (outputs, address, _shutdown) = server().await;
        let mut slow = TcpStream::connect(address).await.unwrap();
        connected(&outputs, 1).await;
        // Without a pause for the client's task, it falls behind at once.
        for _ in 0..4 * MAX_CLIENT_LAG {
            outputs.send(b"line\r\n".to_vec());
        }
        let mut rest = Vec::new();
        let cut = slow.read_to_end(&mut rest).await.unwrap_err();
        assert_eq!(cut.kind(), io::ErrorKind::ConnectionReset);
        let mut quick = BufReader::new(TcpStream::connect(address).await.unwrap()).lines();
        connected(&outputs, 1).await;
        outputs.send(b"after\r\n".to_vec());
        assert_eq!(quick.next_line().await.unwrap().unwrap(), "after");
    }

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
        let (lines, waiting) = broadcast::channel(MAX_CLIENT_LAG);
        let long: Arc<[u8]> = vec![b'x'; 64 * 1024].into();
        lines.send(long).unwrap();
        drop(lines);
        let reason = serve(stream, waiting, Duration::from_millis(50)).await;
        assert_eq!(reason, "it does not read");
        let mut rest = Vec::new();
        let cut = client.read_to_end(&mut rest).await.unwrap_err();
        assert_eq!(cut.kind(), io::ErrorKind::ConnectionReset);
        assert!(rest.len() < 32 * 1024, "{} bytes were kept", rest.len());
    }

    #[cfg(target_os = "linux")]
    #[tokio::test]
    async fn the_kernel_keeps_little_and_not_for_long() {
        let (_client, stream) = small_client().await;
        bound_send_buffer(&stream, write_timeout(1.0)).unwrap();
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

    #[tokio::test]
    async fn datagrams_reach_all_their_addresses() {
        let listener = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        let other = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        let config = OutputConfig {
            udp: vec![listener.local_addr().unwrap(), other.local_addr().unwrap()],
            ..OutputConfig::default()
        };
        let outputs = Outputs::open(&config, &CancellationToken::new())
            .await
            .unwrap();
        for (socket, _) in &outputs.udp {
            socket.writable().await.unwrap();
        }
        outputs.send(b"heading\r\n".to_vec());
        let mut buffer = [0; 64];
        for receiver in [listener, other] {
            let length = receiver.recv(&mut buffer).await.unwrap();
            assert_eq!(&buffer[..length], b"heading\r\n");
        }
    }

    #[tokio::test]
    async fn an_address_in_use_is_named() {
        let (_outputs, address, _shutdown) = server().await;
        let config = OutputConfig {
            tcp_server: vec![address],
            ..OutputConfig::default()
        };
        let error = Outputs::open(&config, &CancellationToken::new())
            .await
            .unwrap_err();
        assert!(error.to_string().contains(&address.to_string()));
    }
}
