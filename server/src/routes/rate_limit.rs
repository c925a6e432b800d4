//! Limit on the requests of each caller, and the headers that state it.
//!
//! Invariants: a caller is a session or token that was accepted before, or else a client's network: an
//! invented token is no new caller. The headers are those
//! of draft-ietf-httpapi-ratelimit-headers-10.

use axum::extract::{Request, State};
use axum::http::{HeaderName, HeaderValue};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use binnacle_platform::access::bearer;
use binnacle_platform::app::App;
use binnacle_platform::client_address::Origin;
use binnacle_platform::error::Error;
use binnacle_platform::request_rates::{Quota, WINDOW_S};
use binnacle_platform::secret;
use binnacle_platform::session::cookie;

const POLICY: HeaderName = HeaderName::from_static("ratelimit-policy");
const LEFT: HeaderName = HeaderName::from_static("ratelimit");

/// Refuses the requests of a caller beyond the limit, and states in each response what is left.
pub(super) async fn limit(State(app): State<App>, request: Request, next: Next) -> Response {
    let (parts, body) = request.into_parts();
    let credential = bearer(&parts).or_else(|| cookie::token(&parts, &app.config));
    let accepted = credential.map(secret::hash);
    let accepted = accepted.filter(|hash| app.accepted.contains(hash));
    let caller =
        accepted.unwrap_or_else(|| Origin::of_request(&parts, &app).network().into_bytes());
    let now_s = u64::try_from(app.clock.now().micros() / 1_000_000).unwrap_or(0);
    let limit = app.config.requests_per_minute;
    let quota = app.request_rates.count(caller, now_s, limit);
    let mut response = if quota.is_exceeded {
        let retry_after_s = quota.resets_in_s;
        Error::TooManyRequests {
            limit,
            retry_after_s,
        }
        .into_response()
    } else {
        next.run(Request::from_parts(parts, body)).await
    };
    let headers = response.headers_mut();
    let [policy, left] = headers_of(quota);
    headers.insert(POLICY, policy);
    headers.insert(LEFT, left);
    response
}

/// Returns the values of the headers that state a quota.
fn headers_of(quota: Quota) -> [HeaderValue; 2] {
    let policy = format!("\"caller\";q={};w={WINDOW_S}", quota.limit);
    let left = format!("\"caller\";r={};t={}", quota.left, quota.resets_in_s);
    [policy, left].map(|text| HeaderValue::try_from(text).expect("digits fit into a header"))
}
