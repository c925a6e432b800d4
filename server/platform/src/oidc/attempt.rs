//! A sign-in under way: what the browser keeps while its person is at the provider's.
//!
//! Invariants: the cookie is the only secret. The values given to the provider do not
//! reveal it. So nothing is stored for a sign-in before it comes back.

use crate::app::App;
use crate::config::Serve;
use crate::secret;
use crate::session::cookie::{self, SameSite};
use axum::http::{HeaderMap, HeaderValue};

/// Time limit for a sign-in at the provider and the code after it, seconds.
pub(super) const LASTS_S: i64 = 600;

const PLAIN: &str = "binnacle_provider";
const SECURE: &str = "__Host-binnacle_provider";

/// The state of a sign-in that the browser keeps.
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

    /// The one that a request's cookie brings, if it is not too old.
    pub(super) fn of(app: &App, headers: &HeaderMap) -> Option<Attempt> {
        let cookie = cookie::value(headers, name(&app.config))?;
        // A time other than the one it was made at gives another state.
        let begun_s: i64 = cookie.split_once('.')?.0.parse().ok()?;
        let attempt = Attempt {
            begun_s,
            cookie: cookie.to_owned(),
        };
        (begun_s..begun_s.checked_add(LASTS_S)?)
            .contains(&now_s(app))
            .then_some(attempt)
    }

    /// Returns the `state` value, which comes back with the provider's answer.
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

    /// Under what it is stored that it came back.
    pub(super) fn state_hash(&self) -> Vec<u8> {
        secret::hash(&self.state())
    }

    /// Seconds since 1970 at which it can end no more.
    pub(super) fn ends_s(&self) -> i64 {
        self.begun_s + LASTS_S
    }

    /// The header that gives it to the browser. The answer comes from another site, so that
    /// the cookie must come along with a link.
    pub(super) fn kept(&self, config: &Serve) -> HeaderValue {
        let lasts_s = LASTS_S.unsigned_abs();
        cookie::header(config, name(config), &self.cookie, lasts_s, SameSite::Lax)
    }
}

/// The header that takes it away.
pub(super) fn forgotten(config: &Serve) -> HeaderValue {
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
