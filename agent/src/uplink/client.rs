//! Requests to the shore and what their answers mean.
//!
//! Nothing counts as an answer but what the shore writes, JSON or the compact form with
//! its checksum, and nothing as its refusal but a problem of its own kinds: what a
//! harbour's network or a proxy says, with whatever status and in whatever form, is a
//! failure of the link.

use super::request::BatchContext;
use super::request_error::{
    PROBLEM_TYPE_PATH, Problem, RequestError, classify_problem, foreign_response, link_error,
};
use crate::config::ConnectionPolicy;
use crate::spool::{Identity, SealedBatch, StoredReport};
use anyhow::Context;
use binnacle_wire::batch::StreamId;
use binnacle_wire::downlink::{self, FORM, ONCE, card_tag};
use binnacle_wire::messages::{
    Downlink, EnrolAnswer, EnrolRequest, LogbookAnswer, NewToken, OpenStreamAnswer,
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

/// A TLS handshake over a satellite takes five seconds and may lose packets.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(30);
/// Between two bytes. A whole exchange has [`ConnectionPolicy::exchange_timeout`].
const READ_TIMEOUT: Duration = Duration::from_secs(90);
/// TLS sessions to resume; there is one shore.
const MAX_TLS_SESSIONS: usize = 4;
/// However long somebody on the way asks the agent to stay away.
const MAX_RETRY_AFTER: Duration = Duration::from_hours(6);
/// No answer is longer.
const MAX_RESPONSE_BYTES: usize = 1 << 20;

/// The shore, as far as HTTP goes.
#[derive(Clone, Debug)]
pub(crate) struct ServerClient {
    http: reqwest::Client,
    /// Remembers the session, whatever becomes of the connections.
    tls: rustls::ClientConfig,
    idle_timeout: Duration,
    exchange_timeout: Duration,
    /// Of answers, since it was last asked.
    received_bytes: Arc<AtomicU64>,
}

/// What the agent already has of what the shore decides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct KnownVersions {
    /// The model's id.
    pub(crate) model: Option<Uuid>,
    /// The settings' version.
    pub(crate) settings: u32,
}

impl ServerClient {
    /// A client that believes the usual authorities, or only the pinned one.
    pub(crate) fn new(
        pinned_ca: Option<&Path>,
        policy: &ConnectionPolicy,
    ) -> anyhow::Result<ServerClient> {
        let mut tls = match pinned_ca {
            // Who pins an authority has a shore of today: older versions need not be offered.
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
            // A server that is not ours may refuse who offers nothing that it speaks.
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

    /// Closes the connection, if there is one: the next request opens another and resumes
    /// its TLS session.
    pub(crate) fn close_connection(&mut self) {
        match client(&self.tls, self.idle_timeout, self.exchange_timeout) {
            Ok(http) => self.http = http,
            Err(error) => tracing::error!("{error:#}"),
        }
    }

    /// The octets of answers since the last call.
    pub(crate) fn take_received_bytes(&self) -> u64 {
        self.received_bytes.swap(0, Ordering::Relaxed)
    }

    /// Exchanges a one-time code for a token.
    pub(crate) async fn enrol(
        &self,
        server: &str,
        code: &str,
    ) -> Result<EnrolAnswer, RequestError> {
        let request = EnrolRequest {
            code: code.to_owned(),
            agent_version: env!("CARGO_PKG_VERSION").to_owned(),
        };
        let url = format!("{server}/api/v1/agents/enrol");
        self.send(self.http.post(url).json(&request)).await
    }

    /// A token that may take the place of the agent's.
    pub(crate) async fn propose_token(
        &self,
        identity: &Identity,
    ) -> Result<NewToken, RequestError> {
        let url = format!("{}/api/v1/agents/token", identity.server);
        self.send(self.http.post(url).bearer_auth(&identity.token))
            .await
    }

    /// Puts it in place; without an answer it may or may not be.
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
        let opened: OpenStreamAnswer = self.send(request).await?;
        Ok(opened.stream)
    }

    /// Sends one batch; success only when the shore says that it is durable.
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
            // No content type: they are octets (RFC 9110, 8.3).
            .body(batch.bytes.clone());
        self.send_for_downlink(request).await
    }

    /// Sends a report for the logbook.
    pub(crate) async fn put_report(
        &self,
        identity: &Identity,
        report: &StoredReport,
    ) -> Result<LogbookAnswer, RequestError> {
        let url = format!("{}/api/v1/agents/logbook/{}", identity.server, report.id);
        let request = self.http.put(url).bearer_auth(&identity.token);
        self.send(request.json(&report.sent)).await
    }

    /// Asks for news.
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

    /// The compact form, or JSON of a shore that does not know it.
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

/// No protocol of HTTP is offered: then a server speaks HTTP/1.1, which is what is wanted.
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
                problem: format!("the shore answered {status}"),
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

/// Whole seconds, within reason; the other form, a date, would need the shore's
/// clock.
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
