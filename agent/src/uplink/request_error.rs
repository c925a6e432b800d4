//! Causes of a request's failure.

use reqwest::StatusCode;
use rustls::CertificateError;
use serde::Deserialize;
use std::fmt;
use std::time::Duration;

/// Why a request did not succeed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum RequestError {
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
    Unauthorized(String),
    /// There is no such thing: of a stream, that the shore lost it.
    NotFound(String),
    /// The shore will never take these bytes.
    Refused(String),
}

impl fmt::Display for RequestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RequestError::Link(problem)
            | RequestError::NoConnection(problem)
            | RequestError::Unauthorized(problem)
            | RequestError::NotFound(problem)
            | RequestError::Refused(problem)
            | RequestError::Busy { problem, .. } => f.write_str(problem),
            RequestError::Forked => f.write_str("the shore has another batch of this number"),
        }
    }
}

/// What the types of the shore's problems have in common, and others' have not.
pub(super) const PROBLEM_TYPE_PATH: &str = "/problems/";

/// RFC 9457, as far as it is read.
#[derive(Deserialize)]
pub(super) struct Problem {
    #[serde(rename = "type")]
    pub(super) kind: String,
    #[serde(default)]
    title: String,
    #[serde(default)]
    detail: String,
}

pub(super) fn classify_problem(
    status: StatusCode,
    problem: &Problem,
    retry_after: Option<Duration>,
) -> RequestError {
    let text = if problem.detail.is_empty() {
        format!("{} {}", status.as_u16(), problem.title)
    } else {
        format!("{} {}: {}", status.as_u16(), problem.title, problem.detail)
    };
    match status {
        StatusCode::CONFLICT if problem.kind.ends_with("stream-forked") => RequestError::Forked,
        StatusCode::UNAUTHORIZED | StatusCode::FORBIDDEN | StatusCode::GONE => {
            RequestError::Unauthorized(text)
        }
        StatusCode::NOT_FOUND => RequestError::NotFound(text),
        StatusCode::TOO_MANY_REQUESTS | StatusCode::REQUEST_TIMEOUT | StatusCode::TOO_EARLY => {
            RequestError::Busy {
                problem: text,
                retry_after,
            }
        }
        status if status.is_client_error() => RequestError::Refused(text),
        _ => RequestError::Busy {
            problem: text,
            retry_after,
        },
    }
}

pub(super) fn foreign_response(status: StatusCode) -> RequestError {
    RequestError::Link(format!(
        "something other than the shore answered ({status}): a network's login page, or a wrong address?"
    ))
}

/// What went wrong while hands were shaken: then there was somebody, and it cost
/// something.
fn find_tls_error<'a>(error: &'a (dyn std::error::Error + 'static)) -> Option<&'a rustls::Error> {
    // What an input or output error wraps is not among its causes.
    let wrapped = error.downcast_ref::<std::io::Error>();
    let wrapped = wrapped.and_then(std::io::Error::get_ref);
    error
        .downcast_ref::<rustls::Error>()
        .or_else(|| wrapped.and_then(|inner| find_tls_error(inner)))
        .or_else(|| error.source().and_then(find_tls_error))
}

/// What is wrong with the certificate of whoever answered, in an officer's words.
fn describe_certificate_error(error: &rustls::Error) -> Option<&'static str> {
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
pub(super) fn link_error(error: &reqwest::Error) -> RequestError {
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
    let tls = find_tls_error(error);
    let problem = match tls.and_then(describe_certificate_error) {
        Some(classify_problem) => classify_problem.to_owned(),
        None => format!("{kind}: {cause}"),
    };
    if error.is_connect() && tls.is_none() {
        RequestError::NoConnection(problem)
    } else {
        RequestError::Link(problem)
    }
}
