//! Mail over TLS, and without it only on the local network.

use binnacle_fleet::alerts;
use binnacle_platform::config;
use binnacle_platform::mail::Mailer;
use binnacle_platform::outbox::{self, Sent};
use binnacle_server_testing::{Encryption, Engine, Relay, TestServer};
use rcgen::{CertifiedKey, generate_simple_self_signed};
use rustls::ServerConfig;
use rustls::pki_types::PrivateKeyDer;
use serde_json::json;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use tokio_rustls::TlsAcceptor;

/// Creates a TLS acceptor for `localhost`, and its self-signed certificate.
fn identity() -> (TlsAcceptor, String) {
    let _ = rustls::crypto::ring::default_provider().install_default();
    let CertifiedKey { cert, signing_key } =
        generate_simple_self_signed(["localhost".to_owned()]).unwrap();
    let key = PrivateKeyDer::try_from(signing_key.serialize_der()).unwrap();
    let config = ServerConfig::builder()
        .with_no_client_auth()
        .with_single_cert(vec![cert.der().clone()], key)
        .unwrap();
    (TlsAcceptor::from(Arc::new(config)), cert.pem())
}

fn mailer(url: String, authority: &Path) -> Mailer {
    let config = config::Mail {
        smtp_url: Some(url),
        smtp_ca: Some(authority.to_owned()),
        mail_from: Some("alerts@binnacle.example".to_owned()),
        public_url: Some("https://binnacle.example".to_owned()),
    };
    let mailer = Mailer::new(&config, alerts::TOPIC_LIST).unwrap().unwrap();
    mailer.with_patience(Duration::from_secs(10))
}

/// Queues a letter and tries to send it once.
async fn send(mailer: &Mailer) -> (Option<Sent>, String) {
    let server = TestServer::start(Engine::Sqlite).await;
    let ada = server.admin("ada").await;
    let new = json!({ "address": "bridge@example.com" });
    let bridge = ada.post("/mail-recipients", &new).await.good();
    let path = format!("/mail-recipients/{}", bridge["id"].as_str().unwrap());
    ada.post(&format!("{path}/test"), &json!({})).await.good();
    let sent = outbox::step(&server.app, mailer).await.unwrap();
    let listed = ada.get(&format!("{path}/deliveries")).await.good();
    let problem = listed["items"][0]["last_error"]
        .as_str()
        .unwrap_or_default();
    let problem = problem.to_owned();
    server.finish().await;
    (sent, problem)
}

#[tokio::test]
async fn credentials_go_only_to_a_relay_with_a_valid_certificate() {
    let folder = tempfile::tempdir().unwrap();
    let authority = folder.path().join("authority.pem");
    let (acceptor, pem) = identity();
    fs::write(&authority, pem).unwrap();
    for (scheme, encryption) in [
        ("smtps", Encryption::Always(acceptor.clone())),
        ("smtp", Encryption::Start(acceptor)),
    ] {
        let relay = Relay::start_with(encryption).await;
        let url = format!("{scheme}://ada:s%40cret@localhost:{}", relay.port);
        let (sent, problem) = send(&mailer(url, &authority)).await;
        assert_eq!(sent, Some(Sent::Delivered), "{scheme}: {problem}");
        assert!(relay.letters()[0].encrypted);
        // base64 of NUL ada NUL s@cret
        let commands = relay.commands();
        assert!(
            commands.contains(&"AUTH PLAIN AGFkYQBzQGNyZXQ=".to_owned()),
            "{commands:?}"
        );
    }
}

#[tokio::test]
async fn a_relay_with_an_invalid_certificate_gets_no_letter_and_no_password() {
    let folder = tempfile::tempdir().unwrap();
    let authority = folder.path().join("authority.pem");
    let (_, pem) = identity();
    fs::write(&authority, pem).unwrap();
    let (stranger, _) = identity();
    for (scheme, encryption) in [
        ("smtps", Encryption::Always(stranger.clone())),
        ("smtp", Encryption::Start(stranger)),
        // It offers no STARTTLS at all.
        ("smtp", Encryption::Nothing),
    ] {
        let relay = Relay::start_with(encryption).await;
        let url = format!("{scheme}://ada:secret@localhost:{}", relay.port);
        let (sent, problem) = send(&mailer(url, &authority)).await;
        assert_eq!(sent, Some(Sent::Failed), "{scheme}");
        assert!(
            !problem.is_empty() && !problem.contains("secret"),
            "{problem}"
        );
        assert_eq!(relay.letters(), []);
        let commands = relay.commands();
        assert!(
            commands.iter().all(|line| !line.starts_with("AUTH")),
            "{commands:?}"
        );
    }
}

#[tokio::test]
async fn without_tls_no_letter_leaves_the_local_network() {
    let _ = rustls::crypto::ring::default_provider().install_default();
    let config = config::Mail {
        smtp_url: Some("smtp://1.1.1.1:25?tls=none".to_owned()),
        mail_from: Some("alerts@binnacle.example".to_owned()),
        public_url: Some("https://binnacle.example".to_owned()),
        smtp_ca: None,
    };
    let (sent, problem) = send(&Mailer::new(&config, alerts::TOPIC_LIST).unwrap().unwrap()).await;
    assert_eq!(sent, Some(Sent::Failed));
    assert!(problem.contains("not within the network"), "{problem}");
}
