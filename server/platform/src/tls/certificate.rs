//! Certificate and key of the server, from two PEM files.

use anyhow::{Context, Result, ensure};
use rustls::ServerConfig;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::server::{ClientHello, ServerSessionMemoryCache};
use std::path::PathBuf;
use std::sync::Arc;

/// TLS sessions that can be resumed; each takes some 300 bytes.
const SESSIONS: usize = 32_768;

/// TLS configurations for handshakes.
#[derive(Clone, Debug)]
pub struct Configs {
    usual: Arc<ServerConfig>,
    /// Configuration without tickets, for clients that do not return while one is valid.
    once: Arc<ServerConfig>,
    /// Application protocol (ALPN) by which a client of one request identifies itself.
    one_request: &'static [u8],
}

impl Configs {
    /// Returns the configuration for the client that sent a hello.
    pub fn for_hello(&self, hello: &ClientHello<'_>) -> Arc<ServerConfig> {
        let mut protocols = hello.alpn().into_iter().flatten();
        if protocols.any(|protocol| protocol == self.one_request) {
            self.once.clone()
        } else {
            self.usual.clone()
        }
    }
}

/// Location of the certificate.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// PEM file: the server's certificate first, then those up to the authority's.
    pub chain: PathBuf,
    /// PEM file: its private key.
    pub key: PathBuf,
    /// Application protocol (ALPN) of clients that make one request and resume no session.
    pub one_request: &'static [u8],
}

impl Certificate {
    /// Reads both files.
    ///
    /// # Errors
    /// Fails when a file cannot be read or holds no certificate or key, or when the two do not
    /// match. The message names the file.
    pub fn load(&self) -> Result<Configs> {
        let name = self.chain.display();
        let chain: Vec<CertificateDer<'static>> = CertificateDer::pem_file_iter(&self.chain)
            .and_then(Iterator::collect)
            .with_context(|| format!("{name}: cannot read the TLS certificate"))?;
        ensure!(!chain.is_empty(), "{name}: contains no certificate");
        let name = self.key.display();
        let key = PrivateKeyDer::from_pem_file(&self.key)
            .with_context(|| format!("{name}: cannot read the TLS key"))?;
        let mut config = ServerConfig::builder()
            .with_no_client_auth()
            .with_single_cert(chain, key)
            .with_context(|| format!("{name}: is not the certificate's key"))?;
        let mut once = config.clone();
        once.send_tls13_tickets = 0;
        config.alpn_protocols = vec![b"h2".to_vec(), b"http/1.1".to_vec()];
        // Each ticket is some hundred bytes over a satellite; one is enough to resume.
        config.send_tls13_tickets = 1;
        // One session for each ship of a large fleet, and for the browsers between two of its
        // uploads. Kept here, a session takes a quarter of the bytes of a self-contained ticket.
        config.session_storage = ServerSessionMemoryCache::new(SESSIONS);
        Ok(Configs {
            usual: Arc::new(config),
            once: Arc::new(once),
            one_request: self.one_request,
        })
    }
}
