//! Protection of the page against requests from other web sites.

use axum::extract::Request;
use axum::http::header::{HOST, ORIGIN};
use axum::http::{HeaderMap, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::net::IpAddr;

/// Header that every change must carry; no page of another site can send it.
const GUARD_HEADER: &str = "x-binnacle-request";

/// Error response: a status, and the mistake in words.
pub(super) type Refusal = (StatusCode, String);

/// Fails when a change has no guard header.
pub(super) fn require_guard_header(headers: &HeaderMap) -> Result<(), Refusal> {
    if headers.get(GUARD_HEADER).is_some_and(|value| value == "1") {
        return Ok(());
    }
    let why = "the header X-Binnacle-Request: 1 is missing";
    Err((StatusCode::FORBIDDEN, why.to_owned()))
}

/// Refuses requests that another site made the browser send.
pub(super) async fn reject_foreign_sites(request: Request, next: Next) -> Response {
    if let Err(why) = check_origin(request.headers()) {
        return (StatusCode::FORBIDDEN, why).into_response();
    }
    next.run(request).await
}

fn check_origin(headers: &HeaderMap) -> Result<(), &'static str> {
    let header = |name| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
    let host = header(HOST).unwrap_or_default();
    if !is_local_name(host) {
        return Err("open this page under the agent's address");
    }
    if header(ORIGIN).is_some_and(|origin| origin != format!("http://{host}")) {
        return Err("requests from other sites are refused");
    }
    Ok(())
}

/// Returns whether a host name is local: an address, `localhost`, a name without dots, or one in
/// `.local`. A name on the internet that resolves to this address is an attack.
fn is_local_name(host: &str) -> bool {
    let name = match host.strip_prefix('[') {
        Some(rest) => {
            return rest
                .split(']')
                .next()
                .is_some_and(|a| a.parse::<IpAddr>().is_ok());
        }
        None => host.split(':').next().unwrap_or_default(),
    };
    name.parse::<IpAddr>().is_ok()
        || (!name.is_empty() && !name.contains('.'))
        || name.to_ascii_lowercase().ends_with(".local")
}
