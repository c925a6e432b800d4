//! The session's cookie, and what every cookie of ours is like.
//!
//! Invariants: scripts cannot read it, other sites' requests do not carry the
//! session's, and where it is for https alone its name begins with `__Host-`, so that no other
//! host of the domain can plant one (RFC 6265bis, section 4.1.3.2).

use crate::config::Serve;
use axum::http::header::{COOKIE, HeaderValue, SET_COOKIE};
use axum::http::{HeaderMap, request::Parts};

/// The name without https.
pub const PLAIN: &str = "binnacle_session";
const SECURE: &str = "__Host-binnacle_session";

/// The name under which this server gives and takes it.
pub fn name(config: &Serve) -> &'static str {
    if config.has_secure_cookies() {
        SECURE
    } else {
        PLAIN
    }
}

/// The token in a request's cookie.
pub fn token<'a>(parts: &'a Parts, config: &Serve) -> Option<&'a str> {
    value(&parts.headers, name(config))
}

/// The value of a request's cookie.
pub fn value<'a>(headers: &'a HeaderMap, wanted: &str) -> Option<&'a str> {
    let values = headers.get_all(COOKIE).iter();
    values
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(';'))
        .filter_map(|pair| pair.trim().split_once('='))
        .find_map(|(name, value)| (name == wanted).then_some(value))
}

/// The header that gives a browser its cookie; an empty token takes it away.
pub(crate) fn set(config: &Serve, token: &str, max_age_s: u64) -> HeaderMap {
    let header = header(config, name(config), token, max_age_s, SameSite::Strict);
    HeaderMap::from_iter([(SET_COOKIE, header)])
}

/// The cross-site requests that carry a cookie.
#[derive(Clone, Copy, Debug)]
pub enum SameSite {
    /// Following a link does.
    Lax,
    /// None does.
    Strict,
}

/// The value of the header that gives a browser a cookie, or, when empty, takes it away.
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
