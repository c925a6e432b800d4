//! The session's cookie.
//!
//! What always holds: scripts cannot read it, other sites' requests do not carry it,
//! and where it is for https alone its name begins with `__Host-`, so that no other
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
    let wanted = name(config);
    let values = parts.headers.get_all(COOKIE).iter();
    values
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(';'))
        .filter_map(|pair| pair.trim().split_once('='))
        .find_map(|(name, value)| (name == wanted).then_some(value))
}

/// The header that gives a browser its cookie; an empty token takes it away.
pub(super) fn set(config: &Serve, token: &str, max_age_s: u64) -> HeaderMap {
    let name = name(config);
    let secure = if config.has_secure_cookies() {
        "; Secure"
    } else {
        ""
    };
    let cookie =
        format!("{name}={token}; Path=/; HttpOnly; SameSite=Strict; Max-Age={max_age_s}{secure}");
    let value = HeaderValue::try_from(cookie).expect("base64url and digits fit into a header");
    HeaderMap::from_iter([(SET_COOKIE, value)])
}
