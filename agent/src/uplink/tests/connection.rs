//! What a connection is used for, over real TLS.

use super::*;
use axum::serve::Listener;
use rcgen::{CertifiedKey, generate_simple_self_signed};
use rustls::HandshakeKind;
use rustls::pki_types::PrivateKeyDer;
use std::net::SocketAddr;
use tokio::net::{TcpListener, TcpStream};
use tokio_rustls::TlsAcceptor;
use tokio_rustls::server::TlsStream;

type Kinds = Arc<Mutex<Vec<Option<HandshakeKind>>>>;

/// Notes how hands were shaken.
struct Tls {
    listener: TcpListener,
    acceptor: TlsAcceptor,
    kinds: Kinds,
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

/// A shore with a certificate of its own: where it is, the certificate, and how hands
/// were shaken.
async fn shore() -> (Identity, String, Kinds) {
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
        kinds: Kinds::default(),
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

/// An agent that believes this certificate only.
fn believer(pem: &str, profile: Profile) -> Shore {
    let directory = TempDir::new().unwrap();
    let pinned = directory.path().join("ca.pem");
    std::fs::write(&pinned, pem).unwrap();
    Shore::new(Some(&pinned), &profile.plan(None).line()).unwrap()
}

/// How hands were shaken when the shore was asked for news so many times in a row.
async fn asked(times: usize, profile: Profile, hangs_up: bool) -> Vec<Option<HandshakeKind>> {
    let (identity, pem, kinds) = shore().await;
    let mut shore = believer(&pem, profile);
    for _ in 0..times {
        shore.downlink(&identity, Have::default()).await.unwrap();
        assert!(shore.take_octets() >= 13);
        if hangs_up {
            shore.hang_up();
        }
    }
    kinds.lock().unwrap().clone()
}

#[tokio::test]
async fn what_follows_at_once_goes_over_the_same_connection() {
    assert_eq!(asked(3, Profile::Standard, false).await.len(), 1);
}

#[tokio::test]
async fn after_a_connection_that_was_hung_up_its_session_is_resumed() {
    let kinds = asked(2, Profile::Standard, true).await;
    let wanted = [Some(HandshakeKind::Full), Some(HandshakeKind::Resumed)];
    assert_eq!(kinds, wanted);
}

#[tokio::test]
async fn who_calls_once_a_day_has_no_session_to_resume() {
    let kinds = asked(2, Profile::Metered, true).await;
    assert_eq!(kinds, [Some(HandshakeKind::Full); 2]);
}

#[tokio::test]
async fn hands_that_were_not_shaken_are_paid_for_and_nobody_at_all_is_not() {
    let (identity_there, pem, _) = shore().await;
    let other = generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
    let suspicious = believer(&other.cert.pem(), Profile::Standard);
    let refused = suspicious.downlink(&identity_there, Have::default()).await;
    let Err(Trouble::Link(said)) = refused else {
        panic!("{refused:?}");
    };
    assert!(said.contains("not believed here"), "{said}");
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let believer = believer(&pem, Profile::Standard);
    let nobody = believer.downlink(&at_port(port), Have::default()).await;
    assert!(
        matches!(nobody, Err(Trouble::NoConnection(_))),
        "{nobody:?}"
    );
}
