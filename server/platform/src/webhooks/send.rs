//! One delivery over HTTP, signed.
//!
//! Invariants: a redirect is not followed and no proxy is used, so that a
//! message goes only to an address that was looked at; what answers is not read
//! beyond its status.

use super::address::is_public;
use super::store;
use crate::app::App;
use crate::outbox::{Carrier, Channel, Claimed, Tried};
use anyhow::{Context, bail};
use hmac::{Hmac, KeyInit, Mac};
use reqwest::dns::{Addrs, Name, Resolve, Resolving};
use reqwest::redirect::Policy;
use reqwest::{Client, Url};
use sha2::Sha256;
use std::fmt::Write;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

/// Carries time and signature.
pub const SIGNATURE_HEADER: &str = "Binnacle-Signature";
/// A receiver that takes longer is tried again.
const PATIENCE: Duration = Duration::from_secs(10);
const MAX_URL: usize = 500;

/// Sender of webhook messages.
#[derive(Clone, Debug)]
pub struct Sender {
    client: Client,
    reach: Reach,
}

/// The addresses to which messages may go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// Over https, to addresses of the public internet.
    Public,
    /// Anywhere, also over http: for receivers in one's own network.
    Anywhere,
}

impl Sender {
    /// Without any connection yet.
    ///
    /// # Errors
    /// When this machine has no certificates to check others by.
    pub fn new(reach: Reach) -> anyhow::Result<Sender> {
        let client = client(reach)?;
        Ok(Sender { client, reach })
    }

    /// Sends a body; answers with the status, whatever it is.
    async fn send(
        &self,
        url: &str,
        secret: &str,
        seconds: i64,
        body: String,
    ) -> anyhow::Result<u16> {
        let url = check_url(url, self.reach)?;
        let request = self
            .client
            .post(url)
            .header("content-type", "application/json")
            .header(SIGNATURE_HEADER, signature(secret, seconds, &body))
            .body(body);
        // An address may contain a secret of the receiver, so no error message quotes it.
        let answer = request.send().await.map_err(reqwest::Error::without_url)?;
        Ok(answer.status().as_u16())
    }
}

impl Carrier for Sender {
    const CHANNEL: Channel = Channel::Webhook;

    async fn carry(&self, app: &App, claimed: &Claimed) -> anyhow::Result<Tried> {
        let found = store::address(&app.db, claimed.receiver_id).await?;
        let (url, secret) = found.context("the webhook was removed")?;
        let seconds = app.clock.now().micros() / 1_000_000;
        let body = claimed.body.clone();
        Ok(match self.send(&url, &secret, seconds, body).await? {
            status @ 200..=299 => Tried::Taken(status),
            // The receiver may still be repaired, so nothing is refused for good.
            status => Tried::Later(status, format!("answered with status {status}")),
        })
    }
}

/// Builds the client for requests to other servers: with a timeout, and without redirects.
///
/// # Errors
/// When this machine has no certificates to check others by.
pub fn client(reach: Reach) -> anyhow::Result<Client> {
    let mut client = Client::builder()
        .redirect(Policy::none())
        .no_proxy()
        .timeout(PATIENCE)
        .user_agent(concat!("Binnacle/", env!("CARGO_PKG_VERSION")));
    if reach == Reach::Public {
        client = client.dns_resolver(Arc::new(PublicOnly));
    }
    Ok(client.build()?)
}

/// An address that may be sent to, as far as it tells by itself.
///
/// # Errors
/// When it is none.
pub fn check_url(text: &str, reach: Reach) -> anyhow::Result<Url> {
    if text.len() > MAX_URL {
        bail!("is longer than {MAX_URL} characters");
    }
    let url = Url::parse(text).context("is not a URL")?;
    match (url.scheme(), reach) {
        ("https", _) | ("http", Reach::Anywhere) => {}
        ("http", Reach::Public) => bail!("is not https"),
        (other, _) => bail!("{other}: is neither https nor http"),
    }
    if !url.username().is_empty() || url.password().is_some() {
        bail!("has a name or password in it");
    }
    let host = url.host_str().unwrap_or_default();
    let address = host
        .trim_start_matches('[')
        .trim_end_matches(']')
        .parse::<IpAddr>();
    if reach == Reach::Public && address.is_ok_and(|address| !is_public(address)) {
        bail!("{host} is not an address of the public internet");
    }
    Ok(url)
}

/// `t=SECONDS,v1=HEX`: HMAC-SHA-256 with the secret over the seconds since 1970, a
/// full stop and the body.
fn signature(secret: &str, seconds: i64, body: &str) -> String {
    let mut mac =
        Hmac::<Sha256>::new_from_slice(secret.as_bytes()).expect("HMAC takes a key of any length");
    mac.update(format!("{seconds}.").as_bytes());
    mac.update(body.as_bytes());
    let mut text = format!("t={seconds},v1=");
    for byte in mac.finalize().into_bytes() {
        write!(text, "{byte:02x}").expect("a String takes every write");
    }
    text
}

/// Finds only addresses of the public internet. The connection is made to what is
/// found here, so that a name cannot mean another address a moment later.
struct PublicOnly;

impl Resolve for PublicOnly {
    fn resolve(&self, name: Name) -> Resolving {
        Box::pin(async move {
            let found = tokio::net::lookup_host((name.as_str(), 0)).await?;
            let public: Vec<SocketAddr> = found.filter(|address| is_public(address.ip())).collect();
            if public.is_empty() {
                let problem = format!("{} has no address of the public internet", name.as_str());
                return Err(problem.into());
            }
            Ok(Box::new(public.into_iter()) as Addrs)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_signature_is_the_documented_one() {
        // printf '1763708400.{"kind":"test"}' | openssl dgst -sha256 -hmac bns_example
        assert_eq!(
            signature("bns_example", 1_763_708_400, r#"{"kind":"test"}"#),
            "t=1763708400,v1=d7c3aea61ac998a67c5f8131cdecbae128ce220c13266516a1068f0f2a7e974b"
        );
    }

    #[test]
    fn an_address_within_the_network_is_refused_however_it_is_written() {
        for refused in [
            "http://example.com/hook",
            "https://127.0.0.1/",
            "https://127.1/",
            "https://0x7f000001/",
            "https://2130706433/",
            "https://[::1]/",
            "https://[::ffff:10.0.0.1]/",
            "https://169.254.169.254/latest/meta-data",
            "https://user:word@example.com/",
            "ftp://example.com/",
            "example.com",
        ] {
            assert!(check_url(refused, Reach::Public).is_err(), "{refused}");
        }
        assert!(check_url("https://example.com:8443/hook?x=1", Reach::Public).is_ok());
        assert!(check_url("http://127.0.0.1:9/", Reach::Anywhere).is_ok());
        assert!(check_url("file:///etc/passwd", Reach::Anywhere).is_err());
    }

    #[tokio::test]
    async fn a_name_that_means_an_address_within_the_network_is_not_found() {
        let found = PublicOnly.resolve("localhost".parse().unwrap()).await;
        let problem = found.err().unwrap().to_string();
        assert!(
            problem.contains("no address of the public internet"),
            "{problem}"
        );
    }
}
