//! Error of the API: a status and an RFC 9457 problem document.
//!
//! Invariants: an internal failure is logged here once and never sent. This module knows no
//! domain: a domain's refusal becomes a [`DomainProblem`] by its own conversion.

use crate::outage::Outage;
use axum::Json;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use rand::RngExt;
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt;
use std::ops::RangeInclusive;
use tracing::{debug, error};
use utoipa::ToSchema;

/// Failure of a request, as every handler returns it.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Missing, or owned by someone else: the response does not reveal which.
    #[error("{0} not found")]
    NotFound(&'static str),
    /// Request without a valid session or token.
    #[error("sign in, or send a valid token")]
    Unauthenticated,
    /// Wrong e-mail or password.
    #[error("e-mail or password is wrong")]
    WrongPassword,
    /// Right password, but a code is needed too.
    #[error("enter the code of your authenticator app, or a recovery code")]
    SecondFactorNeeded,
    /// Right password, but a wrong code.
    #[error("the code is wrong, or was used before")]
    WrongCode,
    /// Second factor required by the operator, but not set up by this user.
    #[error("your company requires a second factor; set one up first")]
    SecondFactorRequired,
    /// Visible to the caller, but not allowed.
    #[error("{0}")]
    Forbidden(&'static str),
    /// Malformed request.
    #[error("{0}")]
    BadRequest(String),
    /// Well-formed request with an invalid value.
    #[error("{field}: {detail}")]
    Invalid {
        /// Field at fault, as named in the request.
        field: &'static str,
        /// Problem with the value.
        detail: String,
    },
    /// Action that is not possible in the current state.
    #[error("{0}")]
    WrongState(String),
    /// Refusal by a domain.
    #[error("{0}")]
    Domain(Box<DomainProblem>),
    /// Feature that this server is not configured for.
    #[error("{0}")]
    NotSetUp(&'static str),
    /// Idempotency key that was used for another request.
    #[error("this idempotency key was used for another request")]
    KeyReused,
    /// Repeated request for something whose secret was shown in the first response.
    #[error("this request was done before; what it made is listed, but its secret is shown once")]
    ShownOnce,
    /// Content that was changed since the caller read it.
    #[error("it was changed since you read it; read it again and repeat your change")]
    Changed,
    /// Resource that existed but can no longer be used.
    #[error("{0}")]
    Gone(&'static str),
    /// Request body over the size limit.
    #[error("the body is larger than {0} bytes")]
    TooLarge(usize),
    /// Unsupported media type.
    #[error("{0}")]
    UnsupportedMediaType(String),
    /// Too many wrong passwords.
    #[error("too many failed attempts; try again in {retry_after_s} s")]
    Throttled {
        /// Seconds to wait.
        retry_after_s: u64,
    },
    /// More requests in a minute than one caller may make.
    #[error("more than {limit} requests in a minute; try again in {retry_after_s} s")]
    TooManyRequests {
        /// Most requests in a minute.
        limit: u32,
        /// Seconds to wait.
        retry_after_s: u64,
    },
    /// More uploads in a day than a vessel may send.
    #[error("more than {limit} uploads in a day; try again in {retry_after_s} s")]
    TooManyUploads {
        /// Most uploads in a day.
        limit: u32,
        /// Seconds to wait.
        retry_after_s: u64,
    },
    /// Too many open streams of events.
    #[error("you have {0} streams of live events open already; close one")]
    TooManyStreams(usize),
    /// Database that does not respond, or has more to do than it can.
    #[error("the server is busy, or its database does not respond; try again in {retry_after_s} s")]
    Unavailable {
        /// Seconds to wait.
        retry_after_s: u64,
    },
    /// Disk of the database without space.
    #[error("the server's disk is full; nothing was stored; try again in {retry_after_s} s")]
    DiskFull {
        /// Seconds to wait.
        retry_after_s: u64,
    },
    /// Path that exists, but not for this method.
    #[error("this path does not support the method")]
    MethodNotAllowed,
    /// Internal failure.
    #[error("internal error; it has been logged")]
    Internal(anyhow::Error),
}

/// Result whose error can be sent to the client.
pub type Result<T> = std::result::Result<T, Error>;

/// Refusal by one domain: its kind, its text, and its own fields.
#[derive(Clone, Debug, PartialEq)]
pub struct DomainProblem {
    /// HTTP status.
    pub status: StatusCode,
    /// Last word of the problem's type.
    pub kind: &'static str,
    /// Kind in a few words.
    pub title: &'static str,
    /// Explanation of this occurrence.
    pub detail: String,
    /// Fields of this kind only, as members of the problem document.
    pub extra: Map<String, Value>,
}

impl fmt::Display for DomainProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.detail)
    }
}

impl DomainProblem {
    /// Adds the fields of a serialisable struct.
    ///
    /// # Panics
    /// Panics when the value is not a struct, which is a mistake in the code.
    #[must_use]
    pub fn with(mut self, extra: &impl Serialize) -> DomainProblem {
        let value = serde_json::to_value(extra).expect("a struct of plain fields is JSON");
        let Value::Object(fields) = value else {
            panic!("only a struct has fields");
        };
        self.extra.extend(fields);
        self
    }
}

impl From<DomainProblem> for Error {
    fn from(problem: DomainProblem) -> Error {
        Error::Domain(Box::new(problem))
    }
}

/// Error as it is sent (RFC 9457).
#[derive(Debug, Serialize, ToSchema)]
pub struct Problem {
    /// Kind of problem; ends in a word that programs may act on.
    #[serde(rename = "type")]
    pub kind: String,
    /// The kind in a few words.
    pub title: String,
    /// The HTTP status.
    pub status: u16,
    /// Details of this occurrence.
    pub detail: String,
    /// Mistakes in the request's body, each with its place.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<Mistake>,
    /// Fields of one kind of problem only; the document lists them by domain.
    #[serde(flatten)]
    #[schema(ignore)]
    pub extra: Map<String, Value>,
}

/// Mistake in a request's body.
#[derive(Debug, Serialize, ToSchema)]
pub struct Mistake {
    /// JSON pointer (RFC 6901) to the value; empty for the whole body.
    #[schema(example = "/terms/fee_eur")]
    pub pointer: String,
    /// Explanation.
    pub detail: String,
}

impl Mistake {
    /// A mistake in a field, whose parts are named like `terms.fee_eur` or `kinds[0]`.
    fn in_field(field: &str, detail: &str) -> Mistake {
        let parts = field.split(['.', '[']);
        let parts = parts.flat_map(|part| ["/", part.trim_end_matches(']')]);
        let pointer = match field {
            "body" => String::new(),
            _ => parts.collect(),
        };
        Mistake {
            pointer,
            detail: detail.to_owned(),
        }
    }
}

impl Error {
    fn kind(&self) -> (StatusCode, &'static str, &'static str) {
        match self {
            Error::NotFound(_) => (StatusCode::NOT_FOUND, "not-found", "Not found"),
            Error::Unauthenticated => {
                (StatusCode::UNAUTHORIZED, "unauthenticated", "Not signed in")
            }
            Error::WrongPassword => (
                StatusCode::UNAUTHORIZED,
                "wrong-password",
                "E-mail or password is wrong",
            ),
            Error::SecondFactorNeeded => (
                StatusCode::UNAUTHORIZED,
                "second-factor-needed",
                "A code is needed",
            ),
            Error::WrongCode => (StatusCode::UNAUTHORIZED, "wrong-code", "The code is wrong"),
            Error::SecondFactorRequired => (
                StatusCode::FORBIDDEN,
                "second-factor-required",
                "A second factor must be set up",
            ),
            Error::Forbidden(_) => (StatusCode::FORBIDDEN, "forbidden", "Not allowed"),
            Error::BadRequest(_) => (StatusCode::BAD_REQUEST, "bad-request", "Cannot be read"),
            Error::Invalid { .. } => (
                StatusCode::UNPROCESSABLE_ENTITY,
                "invalid",
                "A value is not valid",
            ),
            Error::WrongState(_) => (StatusCode::CONFLICT, "wrong-state", "Not in this state"),
            Error::Domain(problem) => (problem.status, problem.kind, problem.title),
            Error::NotSetUp(_) => (StatusCode::CONFLICT, "not-set-up", "Not set up"),
            Error::KeyReused => (
                StatusCode::UNPROCESSABLE_ENTITY,
                "idempotency-key-reused",
                "Idempotency key used before",
            ),
            Error::ShownOnce => (StatusCode::CONFLICT, "shown-once", "Made before"),
            Error::Changed => (
                StatusCode::PRECONDITION_FAILED,
                "changed",
                "Changed meanwhile",
            ),
            Error::Gone(_) => (StatusCode::GONE, "gone", "No longer valid"),
            Error::TooLarge(_) => (StatusCode::PAYLOAD_TOO_LARGE, "too-large", "Body too large"),
            Error::UnsupportedMediaType(_) => (
                StatusCode::UNSUPPORTED_MEDIA_TYPE,
                "unsupported-media-type",
                "Unsupported media type",
            ),
            Error::Throttled { .. } => (
                StatusCode::TOO_MANY_REQUESTS,
                "throttled",
                "Too many attempts",
            ),
            Error::TooManyRequests { .. } => (
                StatusCode::TOO_MANY_REQUESTS,
                "too-many-requests",
                "Too many requests",
            ),
            Error::TooManyUploads { .. } => (
                StatusCode::TOO_MANY_REQUESTS,
                "too-many-uploads",
                "Too many uploads",
            ),
            Error::TooManyStreams(_) => (
                StatusCode::TOO_MANY_REQUESTS,
                "too-many-streams",
                "Too many streams",
            ),
            Error::Unavailable { .. } => (
                StatusCode::SERVICE_UNAVAILABLE,
                "unavailable",
                "Not available now",
            ),
            Error::DiskFull { .. } => (StatusCode::INSUFFICIENT_STORAGE, "disk-full", "Disk full"),
            Error::MethodNotAllowed => (
                StatusCode::METHOD_NOT_ALLOWED,
                "method-not-allowed",
                "Method not allowed",
            ),
            Error::Internal(_) => (
                StatusCode::INTERNAL_SERVER_ERROR,
                "internal",
                "Internal error",
            ),
        }
    }
}

impl IntoResponse for Error {
    fn into_response(self) -> Response {
        let (status, kind, title) = self.kind();
        if let Error::Internal(cause) = &self {
            error!(error = format!("{cause:#}"), "a request failed");
        }
        let problem = Problem {
            kind: format!("/problems/{kind}"),
            title: title.to_owned(),
            status: status.as_u16(),
            detail: self.to_string(),
            errors: match &self {
                Error::Invalid { field, detail } => vec![Mistake::in_field(field, detail)],
                _ => Vec::new(),
            },
            extra: match &self {
                Error::Domain(problem) => problem.extra.clone(),
                _ => Map::new(),
            },
        };
        let mut response = (status, Json(problem)).into_response();
        let headers = response.headers_mut();
        headers.insert(
            header::CONTENT_TYPE,
            HeaderValue::from_static("application/problem+json"),
        );
        if status == StatusCode::UNAUTHORIZED {
            let challenge = HeaderValue::from_static("Bearer realm=\"Binnacle\"");
            headers.insert(header::WWW_AUTHENTICATE, challenge);
        }
        if let Error::Throttled { retry_after_s }
        | Error::TooManyRequests { retry_after_s, .. }
        | Error::TooManyUploads { retry_after_s, .. }
        | Error::Unavailable { retry_after_s }
        | Error::DiskFull { retry_after_s } = self
        {
            headers.insert(header::RETRY_AFTER, HeaderValue::from(retry_after_s));
        }
        response
    }
}

impl From<sqlx::Error> for Error {
    fn from(error: sqlx::Error) -> Error {
        let Some(outage) = Outage::of(&error) else {
            return Error::Internal(error.into());
        };
        debug!(%error, "the database cannot work now");
        // Clients that were refused together must not return together.
        let spread = |seconds: RangeInclusive<u64>| rand::rng().random_range(seconds);
        match outage {
            Outage::Unavailable => Error::Unavailable {
                retry_after_s: spread(5..=30),
            },
            Outage::DiskFull => Error::DiskFull {
                retry_after_s: spread(60..=180),
            },
        }
    }
}

impl From<serde_json::Error> for Error {
    /// Converts an error in the server's own JSON; that of a request is a `JsonRejection`.
    fn from(error: serde_json::Error) -> Error {
        Error::Internal(error.into())
    }
}

impl From<anyhow::Error> for Error {
    fn from(error: anyhow::Error) -> Error {
        match error.downcast::<sqlx::Error>() {
            Ok(error) => error.into(),
            Err(error) => Error::Internal(error),
        }
    }
}

impl From<tokio::task::JoinError> for Error {
    fn from(error: tokio::task::JoinError) -> Error {
        Error::Internal(error.into())
    }
}
