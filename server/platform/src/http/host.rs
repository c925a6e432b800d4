//! Host header: a request has one.
//!
//! Invariants: a proxy and the server never take the same request for different hosts (RFC 9112,
//! section 3.2).

use crate::error::Error;
use axum::extract::{ConnectInfo, Request};
use axum::http::Version;
use axum::http::header::HOST;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::net::SocketAddr;

/// Refuses a request with several Host headers, and one of HTTP/1.1 without any.
pub async fn must_be_one(request: Request, next: Next) -> Response {
    let hosts = request.headers().get_all(HOST).iter().count();
    // HTTP/2 names the host elsewhere, HTTP/1.0 needs none, and what this process asks of itself
    // comes over no connection.
    let is_remote = request
        .extensions()
        .get::<ConnectInfo<SocketAddr>>()
        .is_some();
    let lacks_one = hosts == 0 && is_remote && request.version() == Version::HTTP_11;
    if hosts > 1 || lacks_one {
        let refused = format!("a request has one Host header, and this one has {hosts}");
        return Error::BadRequest(refused).into_response();
    }
    next.run(request).await
}
