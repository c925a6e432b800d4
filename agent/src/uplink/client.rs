//! HTTP client of the server.
//!
//! Only the server's own JSON, or its compact form with a checksum, counts as a response, and only
//! a problem of its own types as a refusal. Anything else, from a harbour's network or a proxy, is
//! a failure of the link, whatever its status and form.

use super::meter::{Meter, Traffic};
use super::request::BatchContext;
use super::request_error::{
    PROBLEM_TYPE_PATH, Problem, RequestError, classify_problem, foreign_response, link_error,
    timed_out,
};
use super::transport::{HttpClient, READ_TIMEOUT, Transport};
use crate::config::ConnectionPolicy;
use crate::spool::{Identity, SealedBatch, SpooledAzimuth, StoredReport};
use anyhow::Context;
use axum::body::Body;
use axum::http::header::{AUTHORIZATION, CONTENT_TYPE, HeaderValue, RETRY_AFTER};
use axum::http::{HeaderMap, Method, Request, StatusCode, Uri};
use binnacle_wire::batch::StreamId;
use binnacle_wire::downlink::{self, FORM, ONCE, card_tag};
use binnacle_wire::messages::{
    BoardAzimuthResponse, Downlink, EnrolRequest, EnrolResponse, LogbookResponse, NewToken,
    OpenStreamResponse,
};
use futures_util::StreamExt;
use rustls::RootCertStore;
use rustls::client::Resumption;
use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject;
use rustls::version::TLS13;
use rustls_platform_verifier::BuilderVerifierExt;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;
use std::time::Duration;
use tokio::time::timeout;
use uuid::Uuid;

/// TLS sessions to resume; there is one server.
const MAX_TLS_SESSIONS: usize = 4;
/// Upper bound of a requested pause, whoever on the way asks for it.
const MAX_RETRY_AFTER: Duration = Duration::from_hours(6);
/// Size limit of a response.
const MAX_RESPONSE_BYTES: usize = 1 << 20;

/// HTTP client of the server.
#[derive(Clone, Debug)]
pub(crate) struct ServerClient {
    http: HttpClient,
    /// Holds the TLS session across connections.
    transport: Transport,
    exchange_timeout: Duration,
    meter: Meter,
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
        let meter = Meter::default();
        let transport = Transport::new(tls, policy, meter.clone());
        Ok(ServerClient {
            http: transport.client(),
            transport,
            exchange_timeout: policy.exchange_timeout,
            meter,
        })
    }

    /// Closes the connection, if there is one. The next request opens another and resumes its TLS
    /// session.
    pub(crate) fn close_connection(&mut self) {
        self.http = self.transport.client();
    }

    /// Returns whether a connection is open.
    pub(crate) fn is_connected(&self) -> bool {
        self.meter.is_connected()
    }

    /// Returns the traffic since the last call.
    pub(crate) fn take_traffic(&self) -> Traffic {
        self.meter.take()
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
        self.send(post(url).json(&request)).await
    }

    /// Requests a token that may replace the agent's.
    pub(crate) async fn propose_token(
        &self,
        identity: &Identity,
    ) -> Result<NewToken, RequestError> {
        let url = format!("{}/api/v1/agents/token", identity.server);
        self.send(post(url).bearer(&identity.token)).await
    }

    /// Activates the new token; without a response it may or may not be active.
    pub(crate) async fn replace_token(
        &self,
        identity: &Identity,
        new: &NewToken,
    ) -> Result<(), RequestError> {
        let url = format!("{}/api/v1/agents/token", identity.server);
        let request = put(url).bearer(&identity.token).json(new);
        self.send_for(request, |body| body.is_empty().then_some(()))
            .await
    }

    /// Opens a new stream for the same compass.
    pub(crate) async fn open_stream(&self, identity: &Identity) -> Result<StreamId, RequestError> {
        let url = format!("{}/api/v1/streams", identity.server);
        let request = post(url).bearer(&identity.token);
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
        let mut request = put(url).bearer(&identity.token);
        // No content type: the body is bytes (RFC 9110, 8.3).
        request.body.clone_from(&batch.bytes);
        self.send_for_downlink(request).await
    }

    /// Sends a report for the logbook.
    pub(crate) async fn put_report(
        &self,
        identity: &Identity,
        report: &StoredReport,
    ) -> Result<LogbookResponse, RequestError> {
        let url = format!("{}/api/v1/agents/logbook/{}", identity.server, report.id);
        let request = put(url).bearer(&identity.token);
        self.send(request.json(&report.sent)).await
    }

    /// Sends an azimuth.
    pub(crate) async fn put_azimuth(
        &self,
        identity: &Identity,
        azimuth: &SpooledAzimuth,
    ) -> Result<BoardAzimuthResponse, RequestError> {
        let url = format!("{}/api/v1/agents/azimuths/{}", identity.server, azimuth.id);
        let request = put(url).bearer(&identity.token);
        self.send(request.json(&azimuth.sent)).await
    }

    /// Polls for a new model and settings.
    pub(crate) async fn downlink(
        &self,
        identity: &Identity,
        known: KnownVersions,
    ) -> Result<Downlink, RequestError> {
        let url = stream_url(identity, "downlink", known);
        let request = Outgoing::new(Method::GET, url).bearer(&identity.token);
        self.send_for_downlink(request).await
    }
}

impl ServerClient {
    async fn send<T: DeserializeOwned>(&self, request: Outgoing) -> Result<T, RequestError> {
        self.send_for(request, |body| serde_json::from_slice(body).ok())
            .await
    }

    /// Sends a request whose response is a downlink: compact, or JSON of a server without that
    /// form.
    async fn send_for_downlink(&self, request: Outgoing) -> Result<Downlink, RequestError> {
        self.send_for(request, |body| {
            if downlink::is_compact(body) {
                downlink::decode(body).ok()
            } else {
                serde_json::from_slice(body).ok()
            }
        })
        .await
    }

    async fn send_for<T>(
        &self,
        request: Outgoing,
        read: impl FnOnce(&[u8]) -> Option<T>,
    ) -> Result<T, RequestError> {
        let exchange = self.exchange(request.into_http()?);
        let (status, headers, body) = timeout(self.exchange_timeout, exchange)
            .await
            .map_err(|_| timed_out())??;
        if status.is_success() {
            return read(&body).ok_or_else(|| foreign_response(status));
        }
        let retry_after = retry_after(&headers);
        let problem = serde_json::from_slice::<Problem>(&body).ok();
        let Some(problem) = problem.filter(|problem| problem.kind.contains(PROBLEM_TYPE_PATH))
        else {
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

    /// Sends a request and reads the whole response. A redirection is not followed.
    async fn exchange(
        &self,
        request: Request<Body>,
    ) -> Result<(StatusCode, HeaderMap, Vec<u8>), RequestError> {
        let response = timeout(READ_TIMEOUT, self.http.request(request))
            .await
            .map_err(|_| timed_out())?
            .map_err(|error| link_error(&error))?;
        let (parts, body) = response.into_parts();
        let mut chunks = Body::new(body).into_data_stream();
        let mut body = Vec::new();
        while let Some(chunk) = timeout(READ_TIMEOUT, chunks.next())
            .await
            .map_err(|_| timed_out())?
        {
            body.extend_from_slice(&chunk.map_err(|error| link_error(&error))?);
            if body.len() > MAX_RESPONSE_BYTES {
                return Err(foreign_response(parts.status));
            }
        }
        Ok((parts.status, parts.headers, body))
    }
}

/// Request to the server.
struct Outgoing {
    method: Method,
    url: String,
    headers: HeaderMap,
    body: Vec<u8>,
}

fn post(url: String) -> Outgoing {
    Outgoing::new(Method::POST, url)
}

fn put(url: String) -> Outgoing {
    Outgoing::new(Method::PUT, url)
}

impl Outgoing {
    fn new(method: Method, url: String) -> Outgoing {
        Outgoing {
            method,
            url,
            headers: HeaderMap::new(),
            body: Vec::new(),
        }
    }

    fn bearer(mut self, token: &str) -> Outgoing {
        // A token that is no header value is none that a server gave: it will be refused.
        if let Ok(mut value) = HeaderValue::try_from(format!("Bearer {token}")) {
            value.set_sensitive(true);
            self.headers.insert(AUTHORIZATION, value);
        }
        self
    }

    fn json(mut self, body: &impl Serialize) -> Outgoing {
        let json = HeaderValue::from_static("application/json");
        self.headers.insert(CONTENT_TYPE, json);
        self.body = serde_json::to_vec(body).expect("messages are plain data");
        self
    }

    fn into_http(self) -> Result<Request<Body>, RequestError> {
        let uri: Uri = self
            .url
            .parse()
            .map_err(|error| RequestError::NoConnection(format!("{}: {error}", self.url)))?;
        let mut request = Request::new(Body::from(self.body));
        *request.method_mut() = self.method;
        *request.uri_mut() = uri;
        *request.headers_mut() = self.headers;
        Ok(request)
    }
}

fn load_root_store(path: &Path) -> anyhow::Result<RootCertStore> {
    let name = path.display();
    let certificates: Vec<CertificateDer<'static>> = CertificateDer::pem_file_iter(path)
        .with_context(|| format!("{name} cannot be read"))?
        .collect::<Result<_, _>>()
        .with_context(|| format!("{name} is not a PEM certificate"))?;
    anyhow::ensure!(!certificates.is_empty(), "{name} has no certificate");
    let mut roots = RootCertStore::empty();
    for certificate in certificates {
        let added = roots.add(certificate);
        added.with_context(|| format!("{name} is not a PEM certificate"))?;
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

fn retry_after(headers: &HeaderMap) -> Option<Duration> {
    parse_retry_after(headers.get(RETRY_AFTER)?.to_str().ok()?)
}

/// Parses whole seconds, up to a limit; the other form, a date, would need the server's clock.
fn parse_retry_after(text: &str) -> Option<Duration> {
    let requested = text.trim().parse().ok().map(Duration::from_secs)?;
    Some(requested.min(MAX_RETRY_AFTER))
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
