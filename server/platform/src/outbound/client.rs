//! HTTP client, and checks of the addresses for it.

use super::address::{is_public, may_be_public};
use anyhow::{Context, bail};
use reqwest::dns::{Addrs, Name, Resolve, Resolving};
use reqwest::redirect::Policy;
use reqwest::{Client, Url};
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

/// Time limit of a request.
const TIMEOUT: Duration = Duration::from_secs(10);
/// Longest accepted URL, bytes.
const MAX_URL: usize = 500;

/// Addresses that requests may reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// Public addresses, over https.
    Public,
    /// Any address, also over http: for receivers in the local network.
    Anywhere,
}

/// Builds the client for requests to other servers: with a timeout, and without redirects.
///
/// # Errors
/// Fails when this machine has no root certificates.
pub fn client(reach: Reach) -> anyhow::Result<Client> {
    client_by(reach, |name| async move {
        let found = tokio::net::lookup_host((name.as_str(), 0)).await?;
        Ok(found.collect())
    })
}

/// Builds the client with a resolver of names.
fn client_by<F>(reach: Reach, lookup: fn(Name) -> F) -> anyhow::Result<Client>
where
    F: Future<Output = std::io::Result<Vec<SocketAddr>>> + Send + 'static,
{
    let mut client = Client::builder()
        .redirect(Policy::none())
        .no_proxy()
        .timeout(TIMEOUT)
        .user_agent(concat!("Binnacle/", env!("CARGO_PKG_VERSION")));
    if reach == Reach::Public {
        client = client.dns_resolver(Arc::new(PublicOnly(lookup)));
    }
    Ok(client.build()?)
}

/// Parses a URL and checks that it may be requested, as far as the text shows.
///
/// # Errors
/// Fails when it may not.
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
    let is_public = address.map_or_else(|_| may_be_public(host), is_public);
    if reach == Reach::Public && !is_public {
        bail!("{host} is not an address of the public internet");
    }
    Ok(url)
}

/// Resolver that returns only addresses of the public internet. The connection is made to the
/// resolved address, so a name cannot resolve differently a moment later.
struct PublicOnly<F>(fn(Name) -> F);

impl<F> Resolve for PublicOnly<F>
where
    F: Future<Output = std::io::Result<Vec<SocketAddr>>> + Send + 'static,
{
    fn resolve(&self, name: Name) -> Resolving {
        let no_address = format!("{} has no address of the public internet", name.as_str());
        let found = (self.0)(name);
        Box::pin(async move {
            let mut public = found.await?;
            public.retain(|address| is_public(address.ip()));
            if public.is_empty() {
                return Err(no_address.into());
            }
            Ok(Box::new(public.into_iter()) as Addrs)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            "https://localhost/",
            "https://LOCALHOST.:8443/",
            "https://hooks.localhost/",
            "https://printer.local/",
            "https://metadata.google.internal/",
            "https://intranet/",
            "ftp://example.com/",
            "example.com",
        ] {
            assert!(check_url(refused, Reach::Public).is_err(), "{refused}");
        }
        assert!(check_url("https://example.com:8443/hook?x=1", Reach::Public).is_ok());
        assert!(check_url("http://127.0.0.1:9/", Reach::Anywhere).is_ok());
        assert!(check_url("file:///etc/passwd", Reach::Anywhere).is_err());
    }

    /// Resolves a name to this machine, as the DNS of an attacker does once the address was checked.
    async fn rebound(_: Name) -> std::io::Result<Vec<SocketAddr>> {
        Ok(vec![SocketAddr::from(([127, 0, 0, 1], 0))])
    }

    #[tokio::test]
    async fn a_name_that_comes_to_mean_a_local_address_is_not_connected_to() {
        let _ = rustls::crypto::ring::default_provider().install_default();
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let port = listener.local_addr().unwrap().port();
        let url = check_url(&format!("https://hooks.example.com:{port}/"), Reach::Public).unwrap();
        let client = client_by(Reach::Public, rebound).unwrap();
        let send = client.post(url.clone()).send();
        let problem = format!("{:?}", send.await.unwrap_err());
        assert!(
            problem.contains("no address of the public internet"),
            "{problem}"
        );
        // The same request arrives where private addresses may be reached.
        let anywhere = Client::builder().dns_resolver(Arc::new(Rebound)).build();
        let arrives = anywhere.unwrap().post(url).send();
        tokio::select! {
            accepted = listener.accept() => assert!(accepted.is_ok()),
            _ = arrives => panic!("it did not connect"),
        }
    }

    struct Rebound;

    impl Resolve for Rebound {
        fn resolve(&self, name: Name) -> Resolving {
            Box::pin(async move { Ok(Box::new(rebound(name).await?.into_iter()) as Addrs) })
        }
    }
}
