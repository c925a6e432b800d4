//! Use of connections, over real TLS.

use super::*;
use axum::serve::Listener;
use rcgen::{CertifiedKey, generate_simple_self_signed};
use rustls::HandshakeKind;
use rustls::pki_types::PrivateKeyDer;
use std::net::SocketAddr;
use tokio::net::{TcpListener, TcpStream};
use tokio_rustls::TlsAcceptor;
use tokio_rustls::server::TlsStream;

type HandshakeKinds = Arc<Mutex<Vec<Option<HandshakeKind>>>>;

/// Records the kind of each handshake.
struct Tls {
    listener: TcpListener,
    acceptor: TlsAcceptor,
    kinds: HandshakeKinds,
}

impl Listener for Tls {
    type Io = TlsStream<TcpStream>;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (TlsStream<TcpStream>, SocketAddr) {
        loop {
            let (stream, address) = self.listener.accept().await.unwrap();
            if let Ok(stream) = self.acceptor.accept(stream).await {
                let kind = stream.get_ref().1.handshake_kind();
                self.kinds.lock().unwrap().push(kind);
                return (stream, address);
            }
        }
    }

    fn local_addr(&self) -> std::io::Result<SocketAddr> {
        self.listener.local_addr()
    }
}

/// Starts a server with a certificate of its own. Returns its address, the certificate, and the
/// kinds of handshakes.
async fn tls_server() -> (Identity, String, HandshakeKinds) {
    rustls::crypto::ring::default_provider()
        .install_default()
        .ok();
    let CertifiedKey { cert, signing_key } =
        generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
    let key = PrivateKeyDer::try_from(signing_key.serialize_der()).unwrap();
    let config = rustls::ServerConfig::builder()
        .with_no_client_auth()
        .with_single_cert(vec![cert.der().clone()], key)
        .unwrap();
    let tls = Tls {
        listener: TcpListener::bind("127.0.0.1:0").await.unwrap(),
        acceptor: TlsAcceptor::from(Arc::new(config)),
        kinds: HandshakeKinds::default(),
    };
    let kinds = tls.kinds.clone();
    let port = tls.local_addr().unwrap().port();
    let router = Router::new()
        .route("/api/v1/streams/{stream}/downlink", get(get_downlink))
        .with_state(Shared::default());
    tokio::spawn(async move { axum::serve(tls, router).await });
    (at_port(port), cert.pem(), kinds)
}

fn at_port(port: u16) -> Identity {
    identity(format!("https://localhost:{port}"))
}

/// Creates a client that trusts this certificate only.
fn trusting_client(pem: &str, profile: Profile) -> ServerClient {
    let directory = TempDir::new().unwrap();
    let pinned = directory.path().join("ca.pem");
    std::fs::write(&pinned, pem).unwrap();
    ServerClient::new(Some(&pinned), &profile.plan(None).connection_policy()).unwrap()
}

/// Returns the kinds of handshakes of several polls in a row.
async fn handshakes(times: usize, profile: Profile, closes: bool) -> Vec<Option<HandshakeKind>> {
    let (identity, pem, kinds) = tls_server().await;
    let mut client = trusting_client(&pem, profile);
    for _ in 0..times {
        client
            .downlink(&identity, KnownVersions::default())
            .await
            .unwrap();
        assert!(client.take_traffic().bytes > 400);
        if closes {
            client.close_connection();
        }
    }
    kinds.lock().unwrap().clone()
}

#[tokio::test]
async fn what_follows_at_once_goes_over_the_same_connection() {
    assert_eq!(handshakes(3, Profile::Standard, false).await.len(), 1);
}

#[tokio::test]
async fn a_session_is_resumed_after_its_connection_was_closed() {
    let kinds = handshakes(2, Profile::Standard, true).await;
    let wanted = [Some(HandshakeKind::Full), Some(HandshakeKind::Resumed)];
    assert_eq!(kinds, wanted);
}

#[tokio::test]
async fn a_client_that_connects_once_a_day_resumes_no_session() {
    let kinds = handshakes(2, Profile::Metered, true).await;
    assert_eq!(kinds, [Some(HandshakeKind::Full); 2]);
}

#[tokio::test]
async fn a_failed_handshake_is_charged_and_a_missing_server_is_not() {
    let (identity_there, pem, _) = tls_server().await;
    let other = generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
    let distrusting = trusting_client(&other.cert.pem(), Profile::Standard);
    let refused = distrusting
        .downlink(&identity_there, KnownVersions::default())
        .await;
    let Err(RequestError::Link(said)) = refused else {
        panic!("{refused:?}");
    };
    assert!(said.contains("not trusted here"), "{said}");
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let client = trusting_client(&pem, Profile::Standard);
    let nobody = client
        .downlink(&at_port(port), KnownVersions::default())
        .await;
    assert!(
        matches!(nobody, Err(RequestError::NoConnection(_))),
        "{nobody:?}"
    );
    assert!(distrusting.take_traffic().bytes > 1_000);
    let attempt = client.take_traffic();
    assert!((1..300).contains(&attempt.bytes), "{attempt:?}");
    assert_eq!(attempt.connection_bytes, None);
}

#[tokio::test]
async fn no_token_goes_to_another_computer_unencrypted_unless_it_is_allowed() {
    let (_, pem, _) = tls_server().await;
    let client = trusting_client(&pem, Profile::Standard);
    let elsewhere = identity("http://192.0.2.1:8080".to_owned());
    let refused = client.downlink(&elsewhere, KnownVersions::default()).await;
    let Err(RequestError::NoConnection(said)) = refused else {
        panic!("{refused:?}");
    };
    assert!(
        said.contains("http to 192.0.2.1 would send the token unencrypted"),
        "{said}"
    );
    assert_eq!(client.take_traffic().bytes, 0, "nothing was sent");
}
