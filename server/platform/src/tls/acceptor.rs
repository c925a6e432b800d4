//! TLS listener: it accepts connections whose handshake is done.

use super::certificate::{Certificate, Configs};
use super::connection::{Tcp, TlsConnection};
use anyhow::Result;
use axum::serve::Listener;
use rustls::server::Acceptor;
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::{Semaphore, mpsc, watch};
use tokio::task::AbortHandle;
use tokio::time::timeout;
use tokio_rustls::LazyConfigAcceptor;
use tracing::{debug, error, info};

/// Time limit of a handshake: over a satellite link that loses packets it takes up to half a
/// minute.
const HANDSHAKE: Duration = Duration::from_mins(1);
/// Maximum number of concurrent handshakes; further connections wait in the system's queue.
const HANDSHAKES: usize = 1024;

type Connection = (TlsConnection, SocketAddr);

/// Listener for TLS connections on a TCP listener. SIGHUP reloads the certificate.
#[derive(Debug)]
pub struct TlsListener {
    ready: mpsc::Receiver<Connection>,
    address: SocketAddr,
    tasks: [AbortHandle; 2],
}

impl TlsListener {
    /// Begins to accept connections.
    ///
    /// # Errors
    /// Fails when the certificate cannot be used, or signals cannot be received.
    pub fn new(listener: TcpListener, certificate: Certificate) -> Result<TlsListener> {
        let address = listener.local_addr()?;
        let (config, in_use) = watch::channel(certificate.load()?);
        let mut hang_up = signal(SignalKind::hangup())?;
        let reload = tokio::spawn(async move {
            while hang_up.recv().await.is_some() {
                match certificate.load() {
                    Ok(new) => {
                        config.send_replace(new);
                        info!("the TLS certificate was reloaded");
                    }
                    Err(error) => {
                        let error = format!("{error:#}");
                        error!(error, "the previous TLS certificate stays in use");
                    }
                }
            }
        });
        let (done, ready) = mpsc::channel(HANDSHAKES);
        let accept = tokio::spawn(accept(listener, in_use, done));
        Ok(TlsListener {
            ready,
            address,
            tasks: [reload.abort_handle(), accept.abort_handle()],
        })
    }
}

impl Drop for TlsListener {
    fn drop(&mut self) {
        for task in &self.tasks {
            task.abort();
        }
    }
}

impl Listener for TlsListener {
    type Io = TlsConnection;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> Connection {
        match self.ready.recv().await {
            Some(connection) => connection,
            // Nothing accepts connections any more: the runtime is stopping.
            None => std::future::pending().await,
        }
    }

    fn local_addr(&self) -> io::Result<SocketAddr> {
        Ok(self.address)
    }
}

async fn accept(
    mut listener: TcpListener,
    in_use: watch::Receiver<Configs>,
    done: mpsc::Sender<Connection>,
) {
    let free = Arc::new(Semaphore::new(HANDSHAKES));
    while let Ok(permit) = free.clone().acquire_owned().await {
        let (stream, peer) = Listener::accept(&mut listener).await;
        let configs = in_use.borrow().clone();
        let done = done.clone();
        tokio::spawn(async move {
            match timeout(HANDSHAKE, handshake(stream, configs)).await {
                Ok(Ok(connection)) => drop(done.send((connection, peer)).await),
                Ok(Err(error)) => debug!(%peer, %error, "the TLS handshake failed"),
                Err(_) => debug!(%peer, "the TLS handshake took too long"),
            }
            drop(permit);
        });
    }
}

async fn handshake(stream: TcpStream, configs: Configs) -> io::Result<TlsConnection> {
    let hello = LazyConfigAcceptor::new(Acceptor::default(), Tcp::new(stream)).await?;
    let config = configs.for_hello(&hello.client_hello());
    Ok(TlsConnection::new(hello.into_stream(config).await?))
}
