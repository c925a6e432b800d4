//! Request rate of each caller, with the headers that state it.
//!
//! Invariants: a caller is a session or token, or else a client address. Each process counts for
//! itself, in windows of a minute. The headers are those of
//! draft-ietf-httpapi-ratelimit-headers-10.

use crate::access::bearer;
use crate::app::App;
use crate::client_address::Origin;
use crate::error::Error;
use crate::secret;
use crate::session::cookie;
use axum::extract::{Request, State};
use axum::http::{HeaderName, HeaderValue};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

const POLICY: HeaderName = HeaderName::from_static("ratelimit-policy");
const LEFT: HeaderName = HeaderName::from_static("ratelimit");
/// Length of a window, seconds.
const WINDOW_S: u64 = 60;
/// Callers to remember at most; beyond that all begin anew.
const MOST_CALLERS: usize = 100_000;

/// Requests of each caller in the present window.
#[derive(Debug, Default)]
pub struct RequestRates(Mutex<Counts>);

#[derive(Debug, Default)]
struct Counts {
    window: u64,
    requests: HashMap<Vec<u8>, u32>,
}

/// What a caller may still ask in this window.
struct Quota {
    limit: u32,
    left: u32,
    resets_in_s: u64,
    is_exceeded: bool,
}

impl RequestRates {
    /// Counts a request at a time, seconds since 1970.
    fn count(&self, caller: Vec<u8>, now_s: u64, limit: u32) -> Quota {
        let mut counts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let window = now_s / WINDOW_S;
        if counts.window != window || counts.requests.len() >= MOST_CALLERS {
            counts.window = window;
            counts.requests.clear();
        }
        let requests = counts.requests.entry(caller).or_default();
        let is_exceeded = *requests >= limit;
        *requests = requests.saturating_add(1);
        Quota {
            limit,
            left: limit.saturating_sub(*requests),
            resets_in_s: WINDOW_S - now_s % WINDOW_S,
            is_exceeded,
        }
    }
}

/// Refuses the requests of a caller beyond the limit, and states in each response what is left.
pub async fn limit(State(app): State<App>, request: Request, next: Next) -> Response {
    let (parts, body) = request.into_parts();
    let credential = bearer(&parts).or_else(|| cookie::token(&parts, &app.config));
    let caller = match credential {
        Some(credential) => secret::hash(credential),
        None => Origin::of_request(&parts, &app).address_text().into_bytes(),
    };
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
    let [policy, left] = quota.headers();
    headers.insert(POLICY, policy);
    headers.insert(LEFT, left);
    response
}

impl Quota {
    fn headers(&self) -> [HeaderValue; 2] {
        let policy = format!("\"caller\";q={};w={WINDOW_S}", self.limit);
        let left = format!("\"caller\";r={};t={}", self.left, self.resets_in_s);
        [policy, left].map(|text| HeaderValue::try_from(text).expect("digits fit into a header"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_caller_has_a_limit_that_begins_anew_with_the_minute() {
        let rates = RequestRates::default();
        let is_refused = |caller: u8, now_s| rates.count(vec![caller], now_s, 2).is_exceeded;
        assert!(!is_refused(1, 60));
        assert!(!is_refused(1, 61));
        assert!(is_refused(1, 119));
        assert!(!is_refused(2, 119));
        assert!(!is_refused(1, 120));
    }
}
