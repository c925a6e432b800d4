//! The server's own TLS.

use axum::Router;
use axum::routing::get;
use binnacle_listener::{Limits, serve as serve_connections};
use binnacle_platform::tls::{Certificate, TlsAcceptor};
use binnacle_wire::downlink::ONCE;
use rcgen::{CertifiedKey, generate_simple_self_signed};
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, ServerName};
use rustls::{ClientConfig, RootCertStore};
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use tempfile::TempDir;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::AbortHandle;
use tokio::time::timeout;
use tokio_rustls::TlsConnector;
use tokio_rustls::client::TlsStream;
use tokio_util::sync::CancellationToken;

const PATIENCE: Duration = Duration::from_mins(1);

/// A server that responds "ashore", with its certificate in a folder.
struct TlsServer {
    folder: TempDir,
    url: String,
    port: u16,
    serving: AbortHandle,
}

impl Drop for TlsServer {
    fn drop(&mut self) {
        self.serving.abort();
    }
}

fn limits() -> Limits {
    Limits {
        connections: 64,
        connections_per_network: None,
        handshake: PATIENCE,
        head: PATIENCE,
        idle: PATIENCE,
        stall: PATIENCE,
        drain: PATIENCE,
    }
}

fn certificate(folder: &Path) -> Certificate {
    Certificate {
        chain: folder.join("chain.pem"),
        key: folder.join("key.pem"),
        one_request: ONCE,
    }
}

/// Writes a new self-signed certificate, and returns it.
fn renew_certificate(folder: &Path) -> String {
    let CertifiedKey { cert, signing_key } =
        generate_simple_self_signed(["localhost".to_owned()]).unwrap();
    let files = certificate(folder);
    fs::write(files.key, signing_key.serialize_pem()).unwrap();
    fs::write(files.chain, cert.pem()).unwrap();
    cert.pem()
}

async fn serve(folder: TempDir) -> TlsServer {
    serve_within(limits(), folder).await
}

async fn serve_within(limits: Limits, folder: TempDir) -> TlsServer {
    let _ = rustls::crypto::ring::default_provider().install_default();
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let port = listener.local_addr().unwrap().port();
    let tls = TlsAcceptor::new(certificate(folder.path())).unwrap();
    let router = Router::new().route("/", get(async || "ashore"));
    let serving = tokio::spawn(serve_connections(
        listener,
        limits,
        |stream| tls.accept(stream),
        router,
        CancellationToken::new(),
    ));
    TlsServer {
        folder,
        url: format!("https://localhost:{port}/"),
        port,
        serving: serving.abort_handle(),
    }
}

/// Sends a request that trusts only `authority`.
async fn ask(url: &str, authority: &str) -> reqwest::Result<String> {
    let authority = reqwest::Certificate::from_pem(authority.as_bytes())?;
    let client = reqwest::Client::builder().tls_certs_only([authority]);
    client.build()?.get(url).send().await?.text().await
}

/// Opens a TLS connection, without a word of HTTP.
async fn connect(server: &TlsServer, authority: &str) -> TlsStream<TcpStream> {
    let mut roots = RootCertStore::empty();
    let authority = CertificateDer::from_pem_slice(authority.as_bytes()).unwrap();
    roots.add(authority).unwrap();
    let config = ClientConfig::builder().with_root_certificates(roots);
    let tls = TlsConnector::from(Arc::new(config.with_no_client_auth()));
    let stream = TcpStream::connect(("127.0.0.1", server.port)).await;
    let name = ServerName::try_from("localhost").unwrap();
    tls.connect(name, stream.unwrap()).await.unwrap()
}

#[tokio::test]
async fn clients_trusting_the_authority_are_served_and_plain_http_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let authority = renew_certificate(folder.path());
    let stranger = renew_certificate(tempfile::tempdir().unwrap().path());
    let served = serve(folder).await;
    assert_eq!(ask(&served.url, &authority).await.unwrap(), "ashore");
    assert!(ask(&served.url, &stranger).await.is_err());
    let plain = format!("http://localhost:{}/", served.port);
    assert!(ask(&plain, &authority).await.is_err());
}

#[tokio::test]
async fn an_endless_handshake_does_not_delay_others() {
    let folder = tempfile::tempdir().unwrap();
    let authority = renew_certificate(folder.path());
    let served = serve(folder).await;
    let address = ("127.0.0.1", served.port);
    let _silent = TcpStream::connect(address).await.unwrap();
    let result = timeout(PATIENCE, ask(&served.url, &authority)).await;
    assert_eq!(result.unwrap().unwrap(), "ashore");
}

#[tokio::test]
async fn silence_in_place_of_a_handshake_and_half_a_head_after_it_are_given_up() {
    let folder = tempfile::tempdir().unwrap();
    let authority = renew_certificate(folder.path());
    let short = Duration::from_millis(500);
    let limits = Limits {
        handshake: short,
        head: short,
        ..limits()
    };
    let served = serve_within(limits, folder).await;
    let mut silent = TcpStream::connect(("127.0.0.1", served.port))
        .await
        .unwrap();
    let mut half = connect(&served, &authority).await;
    half.write_all(b"GET / HTTP/1.1\r\nHo").await.unwrap();
    let mut received = Vec::new();
    let closed = timeout(PATIENCE, silent.read_to_end(&mut received)).await;
    drop(closed.unwrap());
    let closed = timeout(PATIENCE, half.read_to_end(&mut received)).await;
    drop(closed.unwrap());
    assert!(!received.starts_with(b"HTTP/1.1 200"), "{received:?}");
    assert_eq!(ask(&served.url, &authority).await.unwrap(), "ashore");
}

#[tokio::test]
async fn sighup_reloads_a_usable_certificate() {
    let folder = tempfile::tempdir().unwrap();
    let first = renew_certificate(folder.path());
    let served = serve(folder).await;
    let hang_up = || {
        let this = rustix::process::getpid();
        rustix::process::kill_process(this, rustix::process::Signal::HUP).unwrap();
    };
    fs::write(certificate(served.folder.path()).key, "no key").unwrap();
    hang_up();
    assert_eq!(ask(&served.url, &first).await.unwrap(), "ashore");
    let second = renew_certificate(served.folder.path());
    hang_up();
    let renewed = async { while ask(&served.url, &second).await.is_err() {} };
    timeout(PATIENCE, renewed).await.unwrap();
    assert!(ask(&served.url, &first).await.is_err());
}

#[tokio::test]
async fn an_unusable_certificate_is_refused_by_file_name() {
    let _ = rustls::crypto::ring::default_provider().install_default();
    let folder = tempfile::tempdir().unwrap();
    let files = certificate(folder.path());
    let refusal = || format!("{:#}", files.load().unwrap_err());
    assert!(refusal().contains("chain.pem"), "{}", refusal());
    renew_certificate(folder.path());
    let chain = fs::read(&files.chain).unwrap();
    fs::write(&files.chain, "").unwrap();
    assert!(refusal().contains("chain.pem: contains no certificate"));
    renew_certificate(folder.path());
    fs::write(&files.chain, chain).unwrap();
    assert!(refusal().contains("key.pem: is not the certificate's key"));
    fs::write(&files.key, "").unwrap();
    assert!(refusal().contains("key.pem"), "{}", refusal());
}
