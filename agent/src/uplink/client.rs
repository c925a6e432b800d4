//! HTTP client of the server.
//!
//! Only the server's own JSON, or its compact form with a checksum, counts as a response, and only
//! a problem of its own types as a refusal. Anything else, from a harbour's network or a proxy, is
//! a failure of the link, whatever its status and form.

use super::request::BatchContext;
use super::request_error::{
    PROBLEM_TYPE_PATH, Problem, RequestError, classify_problem, foreign_response, link_error,
};
use crate::config::ConnectionPolicy;
use crate::spool::{Identity, SealedBatch, SpooledAzimuth, StoredReport};
use anyhow::Context;
use binnacle_wire::batch::StreamId;
use binnacle_wire::downlink::{self, FORM, ONCE, card_tag};
use binnacle_wire::messages::{
    BoardAzimuthResponse, Downlink, EnrolRequest, EnrolResponse, LogbookResponse, NewToken,
    OpenStreamResponse,
};
use reqwest::header::RETRY_AFTER;
use reqwest::{RequestBuilder, Response, StatusCode, redirect};
use rustls::RootCertStore;
use rustls::client::Resumption;
use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject;
use rustls::version::TLS13;
use rustls_platform_verifier::BuilderVerifierExt;
use serde::de::DeserializeOwned;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use uuid::Uuid;

/// Timeout of a connection: a TLS handshake over a satellite takes five seconds and may lose
/// packets.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(30);
/// Timeout between two bytes. A whole exchange has [`ConnectionPolicy::exchange_timeout`].
const READ_TIMEOUT: Duration = Duration::from_secs(90);
/// TLS sessions to resume; there is one server.
const MAX_TLS_SESSIONS: usize = 4;
/// Upper bound of a requested pause, whoever on the way asks for it.
const MAX_RETRY_AFTER: Duration = Duration::from_hours(6);
/// Size limit of a response.
const MAX_RESPONSE_BYTES: usize = 1 << 20;

/// HTTP client of the server.
#[derive(Clone, Debug)]
pub(crate) struct ServerClient {
    http: reqwest::Client,
    /// Holds the TLS session across connections.
    tls: rustls::ClientConfig,
    idle_timeout: Duration,
    exchange_timeout: Duration,
    /// Bytes of responses since the last call of `take_received_bytes`.
    received_bytes: Arc<AtomicU64>,
}

/// Versions of model and settings that the agent already has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct KnownVersions {
    /// Id of the model.
    pub(crate) model: Option<Uuid>,
    /// Version of the settings.
    pub(crate) settings: u32,
}

impl ServerClient {
    /// Creates a client that trusts the system's authorities, or only the pinned one.
    pub(crate) fn new(
        pinned_ca: Option<&Path>,
        policy: &ConnectionPolicy,
    ) -> anyhow::Result<ServerClient> {
        let mut tls = match pinned_ca {
            // A pinned authority implies a current server: older versions need not be offered.
            Some(path) => rustls::ClientConfig::builder_with_protocol_versions(&[&TLS13])
                .with_root_certificates(load_root_store(path)?)
                .with_no_client_auth(),
            None => rustls::ClientConfig::builder()
                .with_platform_verifier()
                .context("cannot set up TLS")?
                .with_no_client_auth(),
        };
        tls.resumption = if policy.resumes_tls {
            Resumption::in_memory_sessions(MAX_TLS_SESSIONS)
        } else {
            // A foreign server may refuse a client that offers no protocol it speaks.
            tls.alpn_protocols = vec![ONCE.to_vec(), b"http/1.1".to_vec()];
            Resumption::disabled()
        };
        Ok(ServerClient {
            http: client(&tls, policy.idle_timeout, policy.exchange_timeout)?,
            tls,
            idle_timeout: policy.idle_timeout,
            exchange_timeout: policy.exchange_timeout,
            received_bytes: Arc::default(),
        })
    }

    /// Closes the connection, if there is one. The next request opens another and resumes its TLS
    /// session.
    pub(crate) fn close_connection(&mut self) {
        match client(&self.tls, self.idle_timeout, self.exchange_timeout) {
            Ok(http) => self.http = http,
            Err(error) => tracing::error!("{error:#}"),
        }
    }

    /// Returns the bytes of responses since the last call.
    pub(crate) fn take_received_bytes(&self) -> u64 {
        self.received_bytes.swap(0, Ordering::Relaxed)
    }

    /// Exchanges a one-time code for a token.
    pub(crate) async fn enrol(
        &self,
        server: &str,
        code: &str,
    ) -> Result<EnrolResponse, RequestError> {
        let request = EnrolRequest {
            code: code.to_owned(),
            agent_version: env!("CARGO_PKG_VERSION").to_owned(),
        };
        let url = format!("{server}/api/v1/agents/enrol");
        self.send(self.http.post(url).json(&request)).await
    }

    /// Requests a token that may replace the agent's.
    pub(crate) async fn propose_token(
        &self,
        identity: &Identity,
    ) -> Result<NewToken, RequestError> {
        let url = format!("{}/api/v1/agents/token", identity.server);
        self.send(self.http.post(url).bearer_auth(&identity.token))
            .await
    }

    /// Activates the new token; without a response it may or may not be active.
    pub(crate) async fn replace_token(
        &self,
        identity: &Identity,
        new: &NewToken,
    ) -> Result<(), RequestError> {
        let url = format!("{}/api/v1/agents/token", identity.server);
        let request = self.http.put(url).bearer_auth(&identity.token).json(new);
        send(&self.received_bytes, request, |body| {
            body.is_empty().then_some(())
        })
        .await
    }

    /// Opens a new stream for the same compass.
    pub(crate) async fn open_stream(&self, identity: &Identity) -> Result<StreamId, RequestError> {
        let url = format!("{}/api/v1/streams", identity.server);
        let request = self.http.post(url).bearer_auth(&identity.token);
        let opened: OpenStreamResponse = self.send(request).await?;
        Ok(opened.stream)
    }

    /// Sends one batch. Succeeds only when the server says that it is durable.
    pub(crate) async fn put_batch(
        &self,
        identity: &Identity,
        batch: &SealedBatch,
        known: KnownVersions,
        context: BatchContext,
    ) -> Result<Downlink, RequestError> {
        let path = format!("batches/{}", batch.seq);
        let mut url = stream_url(identity, &path, known);
        url.push_str(&context.query(batch));
        let request = self
            .http
            .put(url)
            .bearer_auth(&identity.token)
            // No content type: the body is bytes (RFC 9110, 8.3).
            .body(batch.bytes.clone());
        self.send_for_downlink(request).await
    }

    /// Sends a report for the logbook.
    pub(crate) async fn put_report(
        &self,
        identity: &Identity,
        report: &StoredReport,
    ) -> Result<LogbookResponse, RequestError> {
        let url = format!("{}/api/v1/agents/logbook/{}", identity.server, report.id);
        let request = self.http.put(url).bearer_auth(&identity.token);
        self.send(request.json(&report.sent)).await
    }

    /// Sends an azimuth.
    pub(crate) async fn put_azimuth(
        &self,
        identity: &Identity,
        azimuth: &SpooledAzimuth,
    ) -> Result<BoardAzimuthResponse, RequestError> {
        let url = format!("{}/api/v1/agents/azimuths/{}", identity.server, azimuth.id);
        let request = self.http.put(url).bearer_auth(&identity.token);
        self.send(request.json(&azimuth.sent)).await
    }

    /// Polls for a new model and settings.
    pub(crate) async fn downlink(
        &self,
        identity: &Identity,
        known: KnownVersions,
    ) -> Result<Downlink, RequestError> {
        let request = self
            .http
            .get(stream_url(identity, "downlink", known))
            .bearer_auth(&identity.token);
        self.send_for_downlink(request).await
    }
}

impl ServerClient {
    async fn send<T: DeserializeOwned>(&self, request: RequestBuilder) -> Result<T, RequestError> {
        send(&self.received_bytes, request, |body| {
            serde_json::from_slice(body).ok()
        })
        .await
    }

    /// Sends a request whose response is a downlink: compact, or JSON of a server without that
    /// form.
    async fn send_for_downlink(&self, request: RequestBuilder) -> Result<Downlink, RequestError> {
        send(&self.received_bytes, request, |body| {
            if downlink::is_compact(body) {
                downlink::decode(body).ok()
            } else {
                serde_json::from_slice(body).ok()
            }
        })
        .await
    }
}

/// Builds the HTTP client. Offers no protocol by ALPN, so that a server speaks HTTP/1.1.
fn client(
    tls: &rustls::ClientConfig,
    idle_timeout: Duration,
    exchange_timeout: Duration,
) -> anyhow::Result<reqwest::Client> {
    let mut builder = reqwest::Client::builder()
        .tls_backend_preconfigured(tls.clone())
        .http1_only()
        .redirect(redirect::Policy::none())
        .connect_timeout(CONNECT_TIMEOUT)
        .read_timeout(READ_TIMEOUT)
        .timeout(exchange_timeout)
        .tcp_keepalive(None)
        .pool_idle_timeout(idle_timeout)
        .pool_max_idle_per_host(1);
    #[cfg(target_os = "linux")]
    {
        builder = builder.tcp_user_timeout(READ_TIMEOUT);
    }
    builder.build().context("cannot set up TLS")
}

fn load_root_store(path: &Path) -> anyhow::Result<RootCertStore> {
    let name = path.display();
    let certificates: Vec<CertificateDer<'static>> = CertificateDer::pem_file_iter(path)
        .with_context(|| format!("{name}: pinned_ca"))?
        .collect::<Result<_, _>>()
        .with_context(|| format!("{name}: pinned_ca is not a PEM certificate"))?;
    anyhow::ensure!(
        !certificates.is_empty(),
        "{name}: pinned_ca has no certificate"
    );
    let mut roots = RootCertStore::empty();
    for certificate in certificates {
        let added = roots.add(certificate);
        added.with_context(|| format!("{name}: pinned_ca is not a PEM certificate"))?;
    }
    Ok(roots)
}

fn stream_url(identity: &Identity, path: &str, known: KnownVersions) -> String {
    let (server, stream) = (&identity.server, identity.stream);
    let card = known.model.map(|id| format!("&card={}", card_tag(id)));
    let card = card.unwrap_or_default();
    let settings = match known.settings {
        0 => String::new(),
        version => format!("&settings={version}"),
    };
    format!("{server}/api/v1/streams/{stream}/{path}?form={FORM}{card}{settings}")
}

async fn send<T>(
    received_bytes: &AtomicU64,
    request: RequestBuilder,
    read: impl FnOnce(&[u8]) -> Option<T>,
) -> Result<T, RequestError> {
    let response = request.send().await.map_err(|e| link_error(&e))?;
    let status = response.status();
    let retry_after = retry_after(&response);
    let body = body(received_bytes, response).await?;
    if status.is_success() {
        return read(&body).ok_or_else(|| foreign_response(status));
    }
    let problem = serde_json::from_slice::<Problem>(&body).ok();
    let Some(problem) = problem.filter(|problem| problem.kind.contains(PROBLEM_TYPE_PATH)) else {
        if status.is_server_error() || status == StatusCode::TOO_MANY_REQUESTS {
            return Err(RequestError::Busy {
                problem: format!("the server responded {status}"),
                retry_after,
            });
        }
        return Err(foreign_response(status));
    };
    Err(classify_problem(status, &problem, retry_after))
}

fn retry_after(response: &Response) -> Option<Duration> {
    parse_retry_after(response.headers().get(RETRY_AFTER)?.to_str().ok()?)
}

/// Parses whole seconds, up to a limit; the other form, a date, would need the server's clock.
fn parse_retry_after(text: &str) -> Option<Duration> {
    let requested = text.trim().parse().ok().map(Duration::from_secs)?;
    Some(requested.min(MAX_RETRY_AFTER))
}

async fn body(received_bytes: &AtomicU64, mut response: Response) -> Result<Vec<u8>, RequestError> {
    let mut body = Vec::new();
    while let Some(chunk) = response.chunk().await.map_err(|e| link_error(&e))? {
        received_bytes.fetch_add(chunk.len() as u64, Ordering::Relaxed);
        body.extend_from_slice(&chunk);
        if body.len() > MAX_RESPONSE_BYTES {
            return Err(foreign_response(response.status()));
        }
    }
    Ok(body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_on_the_way_can_silence_the_agent_for_good() {
        assert_eq!(parse_retry_after(" 120 "), Some(Duration::from_mins(2)));
        for endless in ["100000000", "18446744073709551615"] {
            assert_eq!(parse_retry_after(endless), Some(MAX_RETRY_AFTER));
        }
        for nothing in ["", "-1", "Fri, 31 Dec 2027 23:59:59 GMT"] {
            assert_eq!(parse_retry_after(nothing), None);
        }
    }
}
