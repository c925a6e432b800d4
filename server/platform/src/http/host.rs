//! Host header: a request has one.
//!
//! Invariants: a proxy and the server never take the same request for different hosts (RFC 9112,
//! section 3.2).

use crate::error::Error;
use axum::extract::Request;
use axum::http::Version;
use axum::http::header::HOST;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// Refuses a request with several Host headers, and one of HTTP/1.1 without any.
pub async fn must_be_one(request: Request, next: Next) -> Response {
    let hosts = request.headers().get_all(HOST).iter().count();
    // HTTP/2 names the host elsewhere, and HTTP/1.0 needs none.
    if hosts > 1 || (hosts == 0 && request.version() == Version::HTTP_11) {
        let refused = format!("a request has one Host header, and this one has {hosts}");
        return Error::BadRequest(refused).into_response();
    }
    next.run(request).await
}
