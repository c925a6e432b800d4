//! Requests to the shore and what their answers mean.
//!
//! Nothing counts as an answer but the JSON that the shore writes: the login
//! page of a harbour's network, with whatever status, is a failure of the link.

use crate::spool::{Identity, SealedBatch, StoredReport};
use anyhow::Context;
use binnacle_wire::batch::StreamId;
use binnacle_wire::messages::{
    Downlink, EnrolAnswer, EnrolRequest, LogbookAnswer, NewToken, OpenStreamAnswer,
};
use reqwest::header::{CONTENT_TYPE, RETRY_AFTER};
use reqwest::{RequestBuilder, Response, StatusCode, redirect};
use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use std::fmt;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use uuid::Uuid;

/// A TLS handshake over a satellite takes five seconds and may lose packets.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(30);
/// Between two bytes.
const READ_TIMEOUT: Duration = Duration::from_secs(90);
/// Several batches go over one connection. It is trusted for so long after the last of
/// them, no longer: behind a satellite or a firewall it may be gone without a word, and
/// keeping it alive would cost more than opening it again. A new one resumes the TLS
/// session of the one before.
pub(crate) const IDLE_CONNECTION: Duration = Duration::from_secs(5);
/// However long somebody on the way asks the agent to stay away.
const LONGEST_RETRY_AFTER: Duration = Duration::from_hours(6);
/// No answer is longer.
const LARGEST_ANSWER: usize = 1 << 20;

/// The shore, as far as HTTP goes.
#[derive(Clone, Debug)]
pub(crate) struct Shore {
    http: reqwest::Client,
    /// Of answers, since it was last asked.
    octets: Arc<AtomicU64>,
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
    /// The token or the stream is not known (any more).
    Unknown(String),
    /// The shore will never take these bytes.
    Refused(String),
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Trouble::Link(problem)
            | Trouble::NoConnection(problem)
            | Trouble::Unknown(problem)
            | Trouble::Refused(problem)
            | Trouble::Busy { problem, .. } => f.write_str(problem),
            Trouble::Forked => f.write_str("the shore has another batch of this number"),
        }
    }
}

/// RFC 9457, as far as it is read.
#[derive(Deserialize)]
struct Problem {
    #[serde(rename = "type", default)]
    kind: String,
    #[serde(default)]
    title: String,
    #[serde(default)]
    detail: String,
}

impl Shore {
    /// A client that believes the usual authorities, or only the pinned one.
    pub(crate) fn new(pinned_ca: Option<&Path>) -> anyhow::Result<Shore> {
        Shore::with_idle_connections(pinned_ca, IDLE_CONNECTION)
    }

    /// The same, with connections that serve again when they were idle for less than this.
    pub(super) fn with_idle_connections(
        pinned_ca: Option<&Path>,
        longest: Duration,
    ) -> anyhow::Result<Shore> {
        let mut builder = reqwest::Client::builder()
            .http1_only()
            .redirect(redirect::Policy::none())
            .connect_timeout(CONNECT_TIMEOUT)
            .read_timeout(READ_TIMEOUT)
            .tcp_keepalive(None)
            .pool_idle_timeout(longest)
            .pool_max_idle_per_host(1);
        #[cfg(target_os = "linux")]
        {
            builder = builder.tcp_user_timeout(READ_TIMEOUT);
        }
        if let Some(path) = pinned_ca {
            let name = path.display();
            let pem = std::fs::read(path).with_context(|| format!("{name}: pinned_ca"))?;
            let certificates = reqwest::Certificate::from_pem_bundle(&pem)
                .with_context(|| format!("{name}: pinned_ca is not a PEM certificate"))?;
            anyhow::ensure!(
                !certificates.is_empty(),
                "{name}: pinned_ca has no certificate"
            );
            builder = builder.tls_certs_only(certificates);
        }
        let http = builder.build().context("cannot set up TLS")?;
        Ok(Shore {
            http,
            octets: Arc::default(),
        })
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
        let response = request.send().await.map_err(|e| link_trouble(&e))?;
        if response.status() == StatusCode::NO_CONTENT {
            return Ok(());
        }
        match read::<IgnoredAny>(&self.octets, response).await {
            Ok(_) => Err(not_the_shore(StatusCode::OK)),
            Err(trouble) => Err(trouble),
        }
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
    ) -> Result<Downlink, Trouble> {
        let path = format!("batches/{}", batch.seq);
        let request = self
            .http
            .put(stream_url(identity, &path, have))
            .bearer_auth(&identity.token)
            .header(CONTENT_TYPE, "application/octet-stream")
            .body(batch.bytes.clone());
        self.answer(request).await
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
        self.answer(request).await
    }
}

impl Shore {
    async fn answer<T: DeserializeOwned>(&self, request: RequestBuilder) -> Result<T, Trouble> {
        answer(&self.octets, request).await
    }
}

fn stream_url(identity: &Identity, path: &str, have: Have) -> String {
    let (server, stream) = (&identity.server, identity.stream);
    let model = have
        .model
        .map(|id| format!("model={id}&"))
        .unwrap_or_default();
    let settings = have.settings;
    format!("{server}/api/v1/streams/{stream}/{path}?{model}settings={settings}")
}

async fn answer<T: DeserializeOwned>(
    octets: &AtomicU64,
    request: RequestBuilder,
) -> Result<T, Trouble> {
    let response = request.send().await.map_err(|e| link_trouble(&e))?;
    read(octets, response).await
}

async fn read<T: DeserializeOwned>(octets: &AtomicU64, response: Response) -> Result<T, Trouble> {
    let status = response.status();
    let retry_after = retry_after(&response);
    let body = body(octets, response).await?;
    if status.is_success() {
        return serde_json::from_slice(&body).map_err(|_| not_the_shore(status));
    }
    let Ok(problem) = serde_json::from_slice::<Problem>(&body) else {
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
        StatusCode::UNAUTHORIZED
        | StatusCode::FORBIDDEN
        | StatusCode::NOT_FOUND
        | StatusCode::GONE => Trouble::Unknown(text),
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

/// Whether hands were being shaken: then there was somebody, and it cost something.
fn spoke_tls(error: &(dyn std::error::Error + 'static)) -> bool {
    // What an input or output error wraps is not among its causes.
    let wrapped = error.downcast_ref::<std::io::Error>();
    let wrapped = wrapped.and_then(std::io::Error::get_ref);
    error.is::<rustls::Error>()
        || wrapped.is_some_and(|inner| spoke_tls(inner))
        || error.source().is_some_and(spoke_tls)
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
    let problem = format!("{kind}: {cause}");
    if error.is_connect() && !spoke_tls(error) {
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
