//! Connections to the server: TCP, the environment's proxy, TLS, all of it counted.
//!
//! Invariant: nothing is sent unencrypted to another computer, unless the configuration allows it.

use super::meter::{Meter, MeteredStream};
use crate::config::ConnectionPolicy;
use axum::body::Body;
use axum::http::Uri;
use axum::http::uri::Scheme;
use hyper_rustls::{HttpsConnector, MaybeHttpsStream};
use hyper_util::client::legacy::Client;
use hyper_util::client::legacy::connect::proxy::Tunnel;
use hyper_util::client::legacy::connect::{Connected, Connection, HttpConnector};
use hyper_util::client::proxy::matcher::{Intercept, Matcher};
use hyper_util::rt::{TokioExecutor, TokioIo, TokioTimer};
use std::error::Error;
use std::io;
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::timeout;
use tower::util::BoxCloneSyncService;
use tower::{ServiceExt, service_fn};

/// Timeout of a connection: a TLS handshake over a satellite takes five seconds and may lose
/// packets.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(30);
/// Timeout between two bytes. A whole exchange has [`ConnectionPolicy::exchange_timeout`].
pub(super) const READ_TIMEOUT: Duration = Duration::from_secs(90);

type BoxError = Box<dyn Error + Send + Sync>;
type Stream = MaybeHttpsStream<TokioIo<MeteredStream>>;

/// HTTP client over metered connections.
pub(super) type HttpClient = Client<BoxCloneSyncService<Uri, Stream, BoxError>, Body>;

/// Ways to the server.
#[derive(Clone, Debug)]
pub(super) struct Transport {
    tls: Arc<rustls::ClientConfig>,
    proxies: Arc<Matcher>,
    allows_plain_http: bool,
    idle_timeout: Duration,
    meter: Meter,
}

impl Transport {
    /// Creates the transport with the proxies of the environment.
    pub(super) fn new(
        tls: rustls::ClientConfig,
        policy: &ConnectionPolicy,
        meter: Meter,
    ) -> Transport {
        Transport {
            tls: Arc::new(tls),
            proxies: Arc::new(Matcher::from_env()),
            allows_plain_http: policy.allows_plain_http,
            idle_timeout: policy.idle_timeout,
            meter,
        }
    }

    /// Creates an HTTP client without a connection. Offers no protocol by ALPN, so that a server
    /// speaks HTTP/1.1.
    pub(super) fn client(&self) -> HttpClient {
        let transport = self.clone();
        let connect = service_fn(move |uri| {
            let transport = transport.clone();
            async move { transport.connect(uri).await }
        });
        Client::builder(TokioExecutor::new())
            .pool_idle_timeout(self.idle_timeout)
            .pool_max_idle_per_host(1)
            .pool_timer(TokioTimer::new())
            .build(BoxCloneSyncService::new(connect))
    }

    async fn connect(&self, uri: Uri) -> Result<Stream, BoxError> {
        if !self.allows_plain_http {
            ensure_encrypted(&uri)?;
        }
        let mark = self.meter.mark();
        let meter = self.meter.clone();
        let tcp = service_fn(move |uri| open(uri, meter.clone()));
        let is_https = uri.scheme() == Some(&Scheme::HTTPS);
        let proxy = self.proxies.intercept(&uri).filter(|_| is_https);
        let connecting = async {
            if let Some(proxy) = proxy {
                let tunnel = tunnel(&proxy, tcp)?;
                let https = HttpsConnector::from((tunnel, self.tls.clone()));
                https.oneshot(uri).await
            } else {
                let https = HttpsConnector::from((tcp, self.tls.clone()));
                https.oneshot(uri).await
            }
        };
        let stream = timeout(CONNECT_TIMEOUT, connecting)
            .await
            .map_err(|_| io::Error::new(io::ErrorKind::TimedOut, "no response in time"))??;
        self.meter.record_connection(mark);
        Ok(stream)
    }
}

/// Fails for a server on another computer that is not reached by https: whoever is on the way could
/// read the token and change what the agent is sent.
///
/// # Errors
/// Says what to do instead.
pub(crate) fn ensure_encrypted(uri: &Uri) -> Result<(), PlainHttp> {
    let host = uri.host().unwrap_or_default();
    let address: Option<IpAddr> = host.trim_matches(['[', ']']).parse().ok();
    let is_local = host == "localhost" || address.is_some_and(|address| address.is_loopback());
    if is_local || uri.scheme() == Some(&Scheme::HTTPS) {
        return Ok(());
    }
    Err(PlainHttp(host.to_owned()))
}

/// Unencrypted connection to another computer, refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "http to {0} would send the token unencrypted: use https, or set allow_plain_http = true in \
     [uplink] if the whole way is encrypted otherwise"
)]
pub(crate) struct PlainHttp(String);

/// Opens a counted TCP connection to a server or proxy.
async fn open(uri: Uri, meter: Meter) -> Result<TokioIo<MeteredStream>, BoxError> {
    let mut http = HttpConnector::new();
    // The URL of a server that TLS is spoken with.
    http.enforce_http(false);
    http.set_nodelay(true);
    http.set_keepalive(None);
    http.set_connect_timeout(Some(CONNECT_TIMEOUT));
    #[cfg(target_os = "linux")]
    http.set_tcp_user_timeout(Some(READ_TIMEOUT));
    match http.oneshot(uri).await {
        Ok(tcp) => Ok(TokioIo::new(MeteredStream::new(tcp.into_inner(), meter))),
        Err(error) => {
            meter.count_failed_attempt();
            Err(error.into())
        }
    }
}

fn tunnel<C>(proxy: &Intercept, tcp: C) -> Result<Tunnel<C>, BoxError> {
    let uri = proxy.uri();
    if uri.scheme() != Some(&Scheme::HTTP) {
        return Err(format!("the proxy {uri} is not an http proxy").into());
    }
    let tunnel = Tunnel::new(uri.clone(), tcp);
    Ok(match proxy.basic_auth() {
        Some(authorisation) => tunnel.with_auth(authorisation.clone()),
        None => tunnel,
    })
}

impl Connection for MeteredStream {
    fn connected(&self) -> Connected {
        Connected::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_https_leaves_the_computer() {
        let is_allowed = |uri: &str| ensure_encrypted(&uri.parse().unwrap()).is_ok();
        for uri in [
            "https://b.example",
            "https://192.0.2.1:8443/x",
            "http://localhost:8080",
            "http://127.0.0.1",
            "http://127.9.9.9",
            "http://[::1]:8080/api",
        ] {
            assert!(is_allowed(uri), "{uri}");
        }
        for uri in [
            "http://b.example",
            "http://192.168.1.5:8080",
            "http://[fe80::1]",
            "http://localhost.example",
            "http://127.0.0.1.example",
            "http://0.0.0.0",
        ] {
            assert!(!is_allowed(uri), "{uri}");
        }
    }
}
