//! Sign-in attempt: the state that the browser keeps while the user is at the provider.
//!
//! Invariants: the cookie is the only secret. The values sent to the provider do not reveal it.
//! So the server stores nothing for a sign-in before the user returns.

use crate::app::App;
use crate::config::Serve;
use crate::secret;
use crate::session::cookie::{self, SameSite};
use axum::http::{HeaderMap, HeaderValue};

/// Time limit for a sign-in at the provider and the code after it, seconds.
pub(super) const LASTS_S: i64 = 600;

const PLAIN: &str = "binnacle_provider";
const SECURE: &str = "__Host-binnacle_provider";

/// State of a sign-in that the browser keeps.
pub(super) struct Attempt {
    begun_s: i64,
    cookie: String,
}

impl Attempt {
    pub(super) fn new(app: &App) -> Attempt {
        let begun_s = now_s(app);
        Attempt {
            begun_s,
            cookie: format!("{begun_s}.{}", secret::new_token()),
        }
    }

    /// Reads the attempt from a request's cookie, if it is not too old.
    pub(super) fn from_headers(app: &App, headers: &HeaderMap) -> Option<Attempt> {
        let cookie = cookie::value(headers, name(&app.config))?;
        // The time is authentic: another time would give another state.
        let begun_s: i64 = cookie.split_once('.')?.0.parse().ok()?;
        let attempt = Attempt {
            begun_s,
            cookie: cookie.to_owned(),
        };
        (begun_s..begun_s.checked_add(LASTS_S)?)
            .contains(&now_s(app))
            .then_some(attempt)
    }

    /// Returns the `state` value, which the provider's redirect repeats.
    pub(super) fn state(&self) -> String {
        secret::derived("state", &self.cookie)
    }

    /// Returns the `nonce` value, which the provider puts into the token.
    pub(super) fn nonce(&self) -> String {
        secret::derived("nonce", &self.cookie)
    }

    /// Returns the verifier, which is needed to redeem the code (RFC 7636).
    pub(super) fn verifier(&self) -> String {
        secret::derived("verifier", &self.cookie)
    }

    /// Returns the hash under which the return of the attempt is stored.
    pub(super) fn state_hash(&self) -> Vec<u8> {
        secret::hash(&self.state())
    }

    /// Returns the expiry time, seconds since 1970.
    pub(super) fn ends_s(&self) -> i64 {
        self.begun_s + LASTS_S
    }

    /// Returns the header that sets the cookie. The redirect comes from another site, so the
    /// cookie must be sent when a link is followed.
    pub(super) fn set_cookie(&self, config: &Serve) -> HeaderValue {
        let lasts_s = LASTS_S.unsigned_abs();
        cookie::header(config, name(config), &self.cookie, lasts_s, SameSite::Lax)
    }
}

/// Returns the header that deletes the cookie.
pub(super) fn clear_cookie(config: &Serve) -> HeaderValue {
    cookie::header(config, name(config), "", 0, SameSite::Lax)
}

fn name(config: &Serve) -> &'static str {
    if config.has_secure_cookies() {
        SECURE
    } else {
        PLAIN
    }
}

fn now_s(app: &App) -> i64 {
    app.clock.now().micros() / 1_000_000
}
