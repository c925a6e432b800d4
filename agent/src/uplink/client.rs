//! Requests to the shore and what their answers mean.
//!
//! Nothing counts as an answer but what the shore writes, JSON or the compact form with
//! its checksum, and nothing as its refusal but a problem of its own kinds: what a
//! harbour's network or a proxy says, with whatever status and in whatever form, is a
//! failure of the link.

use super::request::Aboard;
use crate::spool::{Identity, SealedBatch, StoredReport};
use anyhow::Context;
use binnacle_wire::batch::StreamId;
use binnacle_wire::downlink::{self, FORM, ONCE, card_tag};
use binnacle_wire::messages::{
    Downlink, EnrolAnswer, EnrolRequest, LogbookAnswer, NewToken, OpenStreamAnswer,
};
use reqwest::header::RETRY_AFTER;
use reqwest::{RequestBuilder, Response, StatusCode, redirect};
use rustls::client::Resumption;
use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject;
use rustls::version::TLS13;
use rustls::{CertificateError, RootCertStore};
use rustls_platform_verifier::BuilderVerifierExt;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::fmt;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use uuid::Uuid;

/// A TLS handshake over a satellite takes five seconds and may lose packets.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(30);
/// Between two bytes. A whole exchange has [`Line::exchange`].
const READ_TIMEOUT: Duration = Duration::from_secs(90);
/// TLS sessions to resume; there is one shore.
const SESSIONS: usize = 4;
/// However long somebody on the way asks the agent to stay away.
const LONGEST_RETRY_AFTER: Duration = Duration::from_hours(6);
/// No answer is longer.
const LARGEST_ANSWER: usize = 1 << 20;

/// The shore, as far as HTTP goes.
#[derive(Clone, Debug)]
pub(crate) struct Shore {
    http: reqwest::Client,
    /// Remembers the session, whatever becomes of the connections.
    tls: rustls::ClientConfig,
    idle_connection: Duration,
    exchange: Duration,
    /// Of answers, since it was last asked.
    octets: Arc<AtomicU64>,
}

/// How connections are used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    /// A connection serves again when it was idle for less than this.
    pub(crate) idle: Duration,
    /// Whether a TLS session is offered again: for a day, no ticket holds longer.
    pub(crate) resumes: bool,
    /// An exchange that takes longer is given up, however busy whoever answers looks.
    pub(crate) exchange: Duration,
}

/// What the agent already has of what the shore decides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Have {
    /// The model's id.
    pub(crate) model: Option<Uuid>,
    /// The settings' version.
    pub(crate) settings: u32,
}

/// Why a request did not succeed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Trouble {
    /// No answer, or none from the shore: try again.
    Link(String),
    /// Not even a connection: try again.
    NoConnection(String),
    /// The shore cannot take it now.
    Busy {
        /// What it said.
        problem: String,
        /// When it wants to be asked again.
        retry_after: Option<Duration>,
    },
    /// This number was used for other bytes: the stream has forked.
    Forked,
    /// The token is not known (any more).
    Unknown(String),
    /// There is no such thing: of a stream, that the shore lost it.
    NotFound(String),
    /// The shore will never take these bytes.
    Refused(String),
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Trouble::Link(problem)
            | Trouble::NoConnection(problem)
            | Trouble::Unknown(problem)
            | Trouble::NotFound(problem)
            | Trouble::Refused(problem)
            | Trouble::Busy { problem, .. } => f.write_str(problem),
            Trouble::Forked => f.write_str("the shore has another batch of this number"),
        }
    }
}

/// What the types of the shore's problems have in common, and others' have not.
const KINDS: &str = "/problems/";

/// RFC 9457, as far as it is read.
#[derive(Deserialize)]
struct Problem {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    title: String,
    #[serde(default)]
    detail: String,
}

impl Shore {
    /// A client that believes the usual authorities, or only the pinned one.
    pub(crate) fn new(pinned_ca: Option<&Path>, line: &Line) -> anyhow::Result<Shore> {
        let mut tls = match pinned_ca {
            // Who pins an authority has a shore of today: older versions need not be offered.
            Some(path) => rustls::ClientConfig::builder_with_protocol_versions(&[&TLS13])
                .with_root_certificates(authorities(path)?)
                .with_no_client_auth(),
            None => rustls::ClientConfig::builder()
                .with_platform_verifier()
                .context("cannot set up TLS")?
                .with_no_client_auth(),
        };
        tls.resumption = if line.resumes {
            Resumption::in_memory_sessions(SESSIONS)
        } else {
            // A server that is not ours may refuse who offers nothing that it speaks.
            tls.alpn_protocols = vec![ONCE.to_vec(), b"http/1.1".to_vec()];
            Resumption::disabled()
        };
        Ok(Shore {
            http: client(&tls, line.idle, line.exchange)?,
            tls,
            idle_connection: line.idle,
            exchange: line.exchange,
            octets: Arc::default(),
        })
    }

    /// Closes the connection, if there is one: the next request opens another and resumes
    /// its TLS session.
    pub(crate) fn hang_up(&mut self) {
        match client(&self.tls, self.idle_connection, self.exchange) {
            Ok(http) => self.http = http,
            Err(error) => tracing::error!("{error:#}"),
        }
    }

    /// The octets of answers since the last call.
    pub(crate) fn take_octets(&self) -> u64 {
        self.octets.swap(0, Ordering::Relaxed)
    }

    /// Exchanges a one-time code for a token.
    pub(crate) async fn enrol(&self, server: &str, code: &str) -> Result<EnrolAnswer, Trouble> {
        let request = EnrolRequest {
            code: code.to_owned(),
            agent_version: env!("CARGO_PKG_VERSION").to_owned(),
        };
        let url = format!("{server}/api/v1/agents/enrol");
        self.answer(self.http.post(url).json(&request)).await
    }

    /// A token that may take the place of the agent's.
    pub(crate) async fn propose_token(&self, identity: &Identity) -> Result<NewToken, Trouble> {
        let url = format!("{}/api/v1/agents/token", identity.server);
        self.answer(self.http.post(url).bearer_auth(&identity.token))
            .await
    }

    /// Puts it in place; without an answer it may or may not be.
    pub(crate) async fn replace_token(
        &self,
        identity: &Identity,
        new: &NewToken,
    ) -> Result<(), Trouble> {
        let url = format!("{}/api/v1/agents/token", identity.server);
        let request = self.http.put(url).bearer_auth(&identity.token).json(new);
        answer(&self.octets, request, |body| body.is_empty().then_some(())).await
    }

    /// Opens a new stream for the same compass.
    pub(crate) async fn open_stream(&self, identity: &Identity) -> Result<StreamId, Trouble> {
        let url = format!("{}/api/v1/streams", identity.server);
        let request = self.http.post(url).bearer_auth(&identity.token);
        let opened: OpenStreamAnswer = self.answer(request).await?;
        Ok(opened.stream)
    }

    /// Sends one batch; success only when the shore says that it is durable.
    pub(crate) async fn put_batch(
        &self,
        identity: &Identity,
        batch: &SealedBatch,
        have: Have,
        aboard: Aboard,
    ) -> Result<Downlink, Trouble> {
        let path = format!("batches/{}", batch.seq);
        let mut url = stream_url(identity, &path, have);
        url.push_str(&aboard.with(batch));
        let request = self
            .http
            .put(url)
            .bearer_auth(&identity.token)
            // No content type: they are octets (RFC 9110, 8.3).
            .body(batch.bytes.clone());
        self.downlink_of(request).await
    }

    /// Sends a report for the logbook.
    pub(crate) async fn put_report(
        &self,
        identity: &Identity,
        report: &StoredReport,
    ) -> Result<LogbookAnswer, Trouble> {
        let url = format!("{}/api/v1/agents/logbook/{}", identity.server, report.id);
        let request = self.http.put(url).bearer_auth(&identity.token);
        self.answer(request.json(&report.sent)).await
    }

    /// Asks for news.
    pub(crate) async fn downlink(
        &self,
        identity: &Identity,
        have: Have,
    ) -> Result<Downlink, Trouble> {
        let request = self
            .http
            .get(stream_url(identity, "downlink", have))
            .bearer_auth(&identity.token);
        self.downlink_of(request).await
    }
}

impl Shore {
    async fn answer<T: DeserializeOwned>(&self, request: RequestBuilder) -> Result<T, Trouble> {
        answer(&self.octets, request, |body| {
            serde_json::from_slice(body).ok()
        })
        .await
    }

    /// The compact form, or JSON of a shore that does not know it.
    async fn downlink_of(&self, request: RequestBuilder) -> Result<Downlink, Trouble> {
        answer(&self.octets, request, |body| {
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
    idle_connection: Duration,
    exchange: Duration,
) -> anyhow::Result<reqwest::Client> {
    let mut builder = reqwest::Client::builder()
        .tls_backend_preconfigured(tls.clone())
        .http1_only()
        .redirect(redirect::Policy::none())
        .connect_timeout(CONNECT_TIMEOUT)
        .read_timeout(READ_TIMEOUT)
        .timeout(exchange)
        .tcp_keepalive(None)
        .pool_idle_timeout(idle_connection)
        .pool_max_idle_per_host(1);
    #[cfg(target_os = "linux")]
    {
        builder = builder.tcp_user_timeout(READ_TIMEOUT);
    }
    builder.build().context("cannot set up TLS")
}

fn authorities(path: &Path) -> anyhow::Result<RootCertStore> {
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

fn stream_url(identity: &Identity, path: &str, have: Have) -> String {
    let (server, stream) = (&identity.server, identity.stream);
    let card = have.model.map(|id| format!("&card={}", card_tag(id)));
    let card = card.unwrap_or_default();
    let settings = match have.settings {
        0 => String::new(),
        version => format!("&settings={version}"),
    };
    format!("{server}/api/v1/streams/{stream}/{path}?form={FORM}{card}{settings}")
}

async fn answer<T>(
    octets: &AtomicU64,
    request: RequestBuilder,
    read: impl FnOnce(&[u8]) -> Option<T>,
) -> Result<T, Trouble> {
    let response = request.send().await.map_err(|e| link_trouble(&e))?;
    let status = response.status();
    let retry_after = retry_after(&response);
    let body = body(octets, response).await?;
    if status.is_success() {
        return read(&body).ok_or_else(|| not_the_shore(status));
    }
    let problem = serde_json::from_slice::<Problem>(&body).ok();
    let Some(problem) = problem.filter(|problem| problem.kind.contains(KINDS)) else {
        if status.is_server_error() || status == StatusCode::TOO_MANY_REQUESTS {
            return Err(Trouble::Busy {
                problem: format!("the shore answered {status}"),
                retry_after,
            });
        }
        return Err(not_the_shore(status));
    };
    Err(trouble(status, &problem, retry_after))
}

fn trouble(status: StatusCode, problem: &Problem, retry_after: Option<Duration>) -> Trouble {
    let text = if problem.detail.is_empty() {
        format!("{} {}", status.as_u16(), problem.title)
    } else {
        format!("{} {}: {}", status.as_u16(), problem.title, problem.detail)
    };
    match status {
        StatusCode::CONFLICT if problem.kind.ends_with("stream-forked") => Trouble::Forked,
        StatusCode::UNAUTHORIZED | StatusCode::FORBIDDEN | StatusCode::GONE => {
            Trouble::Unknown(text)
        }
        StatusCode::NOT_FOUND => Trouble::NotFound(text),
        StatusCode::TOO_MANY_REQUESTS | StatusCode::REQUEST_TIMEOUT | StatusCode::TOO_EARLY => {
            Trouble::Busy {
                problem: text,
                retry_after,
            }
        }
        status if status.is_client_error() => Trouble::Refused(text),
        _ => Trouble::Busy {
            problem: text,
            retry_after,
        },
    }
}

fn not_the_shore(status: StatusCode) -> Trouble {
    Trouble::Link(format!(
        "something other than the shore answered ({status}): a network's login page, or a wrong address?"
    ))
}

fn retry_after(response: &Response) -> Option<Duration> {
    asked_pause(response.headers().get(RETRY_AFTER)?.to_str().ok()?)
}

/// Whole seconds, within reason; the other form, a date, would need the shore's
/// clock.
fn asked_pause(text: &str) -> Option<Duration> {
    let asked = text.trim().parse().ok().map(Duration::from_secs)?;
    Some(asked.min(LONGEST_RETRY_AFTER))
}

async fn body(octets: &AtomicU64, mut response: Response) -> Result<Vec<u8>, Trouble> {
    let mut body = Vec::new();
    while let Some(chunk) = response.chunk().await.map_err(|e| link_trouble(&e))? {
        octets.fetch_add(chunk.len() as u64, Ordering::Relaxed);
        body.extend_from_slice(&chunk);
        if body.len() > LARGEST_ANSWER {
            return Err(not_the_shore(response.status()));
        }
    }
    Ok(body)
}

/// What went wrong while hands were shaken: then there was somebody, and it cost
/// something.
fn tls_error<'a>(error: &'a (dyn std::error::Error + 'static)) -> Option<&'a rustls::Error> {
    // What an input or output error wraps is not among its causes.
    let wrapped = error.downcast_ref::<std::io::Error>();
    let wrapped = wrapped.and_then(std::io::Error::get_ref);
    error
        .downcast_ref::<rustls::Error>()
        .or_else(|| wrapped.and_then(|inner| tls_error(inner)))
        .or_else(|| error.source().and_then(tls_error))
}

/// What is wrong with the certificate of whoever answered, in an officer's words.
fn certificate_trouble(error: &rustls::Error) -> Option<&'static str> {
    let rustls::Error::InvalidCertificate(error) = error else {
        return None;
    };
    Some(match error {
        CertificateError::Expired | CertificateError::ExpiredContext { .. } => {
            "the shore's certificate has expired (or this computer's clock is wrong): nothing \
             is sent until it is renewed"
        }
        CertificateError::NotValidYet | CertificateError::NotValidYetContext { .. } => {
            "the shore's certificate is not valid yet (or this computer's clock is wrong)"
        }
        CertificateError::UnknownIssuer | CertificateError::BadSignature => {
            "whoever answers has a certificate of an authority that is not believed here: \
             another network's, or pinned_ca is wrong"
        }
        CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. } => {
            "whoever answers has the certificate of another server"
        }
        _ => return None,
    })
}

/// The innermost cause says most: "connection refused", "certificate expired".
fn link_trouble(error: &reqwest::Error) -> Trouble {
    let mut cause: &dyn std::error::Error = error;
    while let Some(inner) = cause.source() {
        cause = inner;
    }
    let kind = if error.is_timeout() {
        "no answer in time"
    } else if error.is_connect() {
        "cannot connect"
    } else {
        "the connection broke"
    };
    let tls = tls_error(error);
    let problem = match tls.and_then(certificate_trouble) {
        Some(trouble) => trouble.to_owned(),
        None => format!("{kind}: {cause}"),
    };
    if error.is_connect() && tls.is_none() {
        Trouble::NoConnection(problem)
    } else {
        Trouble::Link(problem)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_on_the_way_can_silence_the_agent_for_good() {
        assert_eq!(asked_pause(" 120 "), Some(Duration::from_mins(2)));
        for endless in ["100000000", "18446744073709551615"] {
            assert_eq!(asked_pause(endless), Some(LONGEST_RETRY_AFTER));
        }
        for nothing in ["", "-1", "Fri, 31 Dec 2027 23:59:59 GMT"] {
            assert_eq!(asked_pause(nothing), None);
        }
    }
}
