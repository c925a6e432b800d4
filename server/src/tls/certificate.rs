//! The server's certificate and key, from two PEM files.

use anyhow::{Context, Result, ensure};
use rustls::ServerConfig;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use std::path::PathBuf;
use std::sync::Arc;

/// Where the certificate is kept.
#[derive(Clone, Debug)]
pub struct Certificate {
    /// PEM: the server's certificate first, then those up to the authority's.
    pub chain: PathBuf,
    /// PEM: its private key.
    pub key: PathBuf,
}

impl Certificate {
    /// Reads both files.
    ///
    /// # Errors
    /// When one cannot be read, holds no certificate or key, or they do not belong
    /// together; the message names the file.
    pub fn load(&self) -> Result<Arc<ServerConfig>> {
        let name = self.chain.display();
        let chain: Vec<CertificateDer<'static>> = CertificateDer::pem_file_iter(&self.chain)
            .and_then(Iterator::collect)
            .with_context(|| format!("{name}: cannot read the TLS certificate"))?;
        ensure!(!chain.is_empty(), "{name}: there is no certificate in it");
        let name = self.key.display();
        let key = PrivateKeyDer::from_pem_file(&self.key)
            .with_context(|| format!("{name}: cannot read the TLS key"))?;
        let mut config = ServerConfig::builder()
            .with_no_client_auth()
            .with_single_cert(chain, key)
            .with_context(|| format!("{name}: not the certificate's key"))?;
        config.alpn_protocols = vec![b"h2".to_vec(), b"http/1.1".to_vec()];
        // Each ticket is some hundred bytes over a satellite; one is enough to resume.
        config.send_tls13_tickets = 1;
        Ok(Arc::new(config))
    }
}
