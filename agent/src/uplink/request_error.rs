//! Reasons for a failed request.

use axum::http::StatusCode;
use hyper_util::client::legacy;
use rustls::CertificateError;
use serde::Deserialize;
use std::fmt;
use std::time::Duration;

/// Reason for a failed request.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum RequestError {
    /// No response, or none from the server: try again.
    Link(String),
    /// No connection: try again.
    NoConnection(String),
    /// The server cannot process it now.
    Busy {
        /// Text of the server.
        problem: String,
        /// Pause that the server asks for.
        retry_after: Option<Duration>,
    },
    /// The number was used for other bytes: the stream has forked.
    Forked,
    /// The token is unknown.
    Unauthorized(String),
    /// The resource does not exist; for a stream, the server lost it.
    NotFound(String),
    /// The server refuses these bytes for good, or what it says of them cannot be true.
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
            RequestError::Forked => f.write_str("the server has another batch of this number"),
        }
    }
}

/// Common part of the server's problem types, which others lack.
pub(super) const PROBLEM_TYPE_PATH: &str = "/problems/";

/// Problem document of RFC 9457, reduced to the fields in use.
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
        "the response is not from the server ({status}): a network's login page, or a wrong address?"
    ))
}

/// Returns the TLS error in a chain of causes: then there was a connection, and it cost something.
fn find_tls_error(error: &Cause) -> Option<&rustls::Error> {
    // The inner error of an input or output error is not among its causes.
    let wrapped = error.downcast_ref::<std::io::Error>();
    let wrapped = wrapped.and_then(std::io::Error::get_ref);
    error
        .downcast_ref::<rustls::Error>()
        .or_else(|| wrapped.and_then(|inner| find_tls_error(inner)))
        .or_else(|| error.source().and_then(find_tls_error))
}

/// Describes a certificate error for an officer.
fn describe_certificate_error(error: &rustls::Error) -> Option<&'static str> {
    let rustls::Error::InvalidCertificate(error) = error else {
        return None;
    };
    Some(match error {
        CertificateError::Expired | CertificateError::ExpiredContext { .. } => {
            "the server's certificate has expired (or this computer's clock is wrong): nothing \
             is sent until it is renewed"
        }
        CertificateError::NotValidYet | CertificateError::NotValidYetContext { .. } => {
            "the server's certificate is not valid yet (or this computer's clock is wrong)"
        }
        CertificateError::UnknownIssuer | CertificateError::BadSignature => {
            "the certificate is of an authority that is not trusted here: another network \
             responded, or pinned_ca is wrong"
        }
        CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. } => {
            "the certificate belongs to another server"
        }
        _ => return None,
    })
}

/// Error of the transport, or a cause of it.
type Cause = dyn std::error::Error + 'static;

/// Returns the error of a response that did not come in time.
pub(super) fn timed_out() -> RequestError {
    RequestError::Link("no response in time".to_owned())
}

/// Converts a transport error. The innermost cause says most: "connection refused", "certificate
/// expired".
pub(super) fn link_error(error: &Cause) -> RequestError {
    let is_connect = error
        .downcast_ref::<legacy::Error>()
        .is_some_and(legacy::Error::is_connect);
    let mut cause = error;
    while let Some(inner) = cause.source() {
        cause = inner;
    }
    let kind = if is_connect {
        "cannot connect"
    } else {
        "the connection broke"
    };
    let tls = find_tls_error(error);
    let problem = match tls.and_then(describe_certificate_error) {
        Some(problem) => problem.to_owned(),
        None => format!("{kind}: {cause}"),
    };
    if is_connect && tls.is_none() {
        RequestError::NoConnection(problem)
    } else {
        RequestError::Link(problem)
    }
}
