//! Errors of requests that the extractors cannot read.

use super::MAX_JSON_BYTES;
use crate::error::Error;
use axum::extract::rejection::{JsonRejection, PathRejection, QueryRejection};
use axum::http::StatusCode;

impl From<JsonRejection> for Error {
    fn from(rejection: JsonRejection) -> Error {
        match rejection {
            JsonRejection::JsonDataError(error) => Error::Invalid {
                field: "body",
                detail: error.body_text(),
            },
            JsonRejection::MissingJsonContentType(error) => {
                Error::UnsupportedMediaType(error.body_text())
            }
            JsonRejection::BytesRejection(error)
                if error.status() == StatusCode::PAYLOAD_TOO_LARGE =>
            {
                Error::TooLarge(MAX_JSON_BYTES)
            }
            other => Error::BadRequest(other.body_text()),
        }
    }
}

impl From<QueryRejection> for Error {
    fn from(rejection: QueryRejection) -> Error {
        Error::BadRequest(rejection.body_text())
    }
}

impl From<PathRejection> for Error {
    /// A path that does not parse names nothing that exists.
    fn from(_: PathRejection) -> Error {
        Error::NotFound("page")
    }
}
