//! Session cookie, and the attributes of all cookies of this server.
//!
//! Invariants: scripts cannot read a cookie. Requests from other sites do not carry the session
//! cookie. A cookie that is limited to https has a name with the prefix `__Host-`, so that no
//! other host of the domain can plant one (RFC 6265bis, section 4.1.3.2).

use crate::config::Serve;
use axum::http::header::{COOKIE, HeaderValue, SET_COOKIE};
use axum::http::{HeaderMap, request::Parts};

/// Name of the session cookie without https.
pub const PLAIN: &str = "binnacle_session";
const SECURE: &str = "__Host-binnacle_session";

/// Returns the name of the session cookie on this server.
pub fn name(config: &Serve) -> &'static str {
    if config.has_secure_cookies() {
        SECURE
    } else {
        PLAIN
    }
}

/// Returns the token in a request's session cookie.
pub fn token<'a>(parts: &'a Parts, config: &Serve) -> Option<&'a str> {
    value(&parts.headers, name(config))
}

/// Returns the value of a cookie in a request.
pub fn value<'a>(headers: &'a HeaderMap, wanted: &str) -> Option<&'a str> {
    let values = headers.get_all(COOKIE).iter();
    values
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(';'))
        .filter_map(|pair| pair.trim().split_once('='))
        .find_map(|(name, value)| (name == wanted).then_some(value))
}

/// Returns the header that sets the session cookie; an empty token deletes it.
pub(crate) fn set(config: &Serve, token: &str, max_age_s: u64) -> HeaderMap {
    let header = header(config, name(config), token, max_age_s, SameSite::Strict);
    HeaderMap::from_iter([(SET_COOKIE, header)])
}

/// Cross-site requests that carry a cookie.
#[derive(Clone, Copy, Debug)]
pub enum SameSite {
    /// Only those that follow a link.
    Lax,
    /// None.
    Strict,
}

/// Returns the header value that sets a cookie; an empty value deletes it.
#[allow(clippy::missing_panics_doc, reason = "it cannot: see the message")]
pub fn header(
    config: &Serve,
    name: &str,
    value: &str,
    max_age_s: u64,
    same_site: SameSite,
) -> HeaderValue {
    let secure = if config.has_secure_cookies() {
        "; Secure"
    } else {
        ""
    };
    let cookie = format!(
        "{name}={value}; Path=/; HttpOnly; SameSite={same_site:?}; Max-Age={max_age_s}{secure}"
    );
    HeaderValue::try_from(cookie).expect("base64url and digits fit into a header")
}
