//! TLS handshakes of the server.

use super::certificate::{Certificate, Configs};
use super::connection::{Tcp, TlsConnection};
use anyhow::Result;
use binnacle_listener::Stream;
use rustls::server::Acceptor;
use std::io;
use std::sync::Arc;
use std::time::Duration;
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::watch;
use tokio::time::timeout;
use tokio_rustls::LazyConfigAcceptor;
use tokio_util::task::AbortOnDropHandle;
use tracing::{error, info};

/// Time limit of the client's hello, its first message.
const HELLO: Duration = Duration::from_secs(15);

/// Acceptor of TLS connections. SIGHUP reloads the certificate.
#[derive(Clone, Debug)]
pub struct TlsAcceptor {
    in_use: watch::Receiver<Configs>,
    _reload: Arc<AbortOnDropHandle<()>>,
}

impl TlsAcceptor {
    /// Reads the certificate, and begins to watch for SIGHUP.
    ///
    /// # Errors
    /// Fails when the certificate cannot be used, or signals cannot be received.
    pub fn new(certificate: Certificate) -> Result<TlsAcceptor> {
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
        Ok(TlsAcceptor {
            in_use,
            _reload: Arc::new(AbortOnDropHandle::new(reload)),
        })
    }

    /// Performs the handshake of a connection.
    ///
    /// # Errors
    /// Fails when the client does not speak TLS, breaks off, or says nothing.
    pub async fn accept(self, stream: Stream) -> io::Result<TlsConnection> {
        let hello = LazyConfigAcceptor::new(Acceptor::default(), Tcp::new(stream));
        let hello = timeout(HELLO, hello).await??;
        let config = self.in_use.borrow().for_hello(&hello.client_hello());
        Ok(TlsConnection::new(hello.into_stream(config).await?))
    }
}
