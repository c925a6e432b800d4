//! Known devices: browsers in which a user signed in before, by a cookie.
//!
//! Invariants: the cookie lets nobody in. It only keeps the failures of strangers apart from those of
//! this browser (OWASP, "Device Cookies"). It is random, stored as a hash, replaced at each sign-in,
//! and good for one user and a year.

use super::cookie::{self, SameSite};
use crate::app::App;
use crate::client_address::Origin;
use crate::config::Serve;
use crate::db::{self, Db, Tx, execute, row};
use crate::ed25519::to_hex;
use crate::ids::UserId;
use crate::secret;
use crate::time::Time;
use axum::extract::{FromRef, FromRequestParts};
use axum::http::HeaderValue;
use axum::http::request::Parts;
use std::convert::Infallible;

const PLAIN: &str = "binnacle_device";
const SECURE: &str = "__Host-binnacle_device";
/// Time for which a browser is known after a sign-in, seconds.
const KNOWN_FOR_S: u64 = 365 * 86_400;
/// Known devices of a user; beyond that the oldest is forgotten.
const MOST: i64 = 20;

/// Client that comes to sign in: where from, and with which device.
#[derive(Clone, Debug, Default)]
pub struct Visitor {
    /// Origin of the request.
    pub from: Origin,
    /// Hash of the token in the device's cookie.
    device: Option<Vec<u8>>,
}

impl<S> FromRequestParts<S> for Visitor
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Visitor, Infallible> {
        let app = App::from_ref(state);
        let token = cookie::value(&parts.headers, name(&app.config));
        Ok(Visitor {
            from: Origin::of_request(parts, &app),
            device: token.map(secret::hash),
        })
    }
}

/// Returns the name under which failures of a known device are counted; none if the user of the
/// e-mail address has not signed in there.
pub(super) async fn find_known(
    db: &Db,
    email: &str,
    visitor: &Visitor,
) -> db::Result<Option<String>> {
    let Some(device) = &visitor.device else {
        return Ok(None);
    };
    let found = row!(
        db,
        (UserId,),
        "SELECT d.user_id FROM known_devices d
         JOIN users u ON u.id = d.user_id
         WHERE u.email = $1 AND d.token_hash = $2
         ORDER BY d.user_id",
        email,
        device.as_slice()
    )?;
    Ok(found.map(|(user,)| format!("device {} of {user}", to_hex(device))))
}

/// Makes the browser of a sign-in known, and returns its new token.
pub(super) async fn remember(
    tx: &mut Tx,
    user: UserId,
    visitor: &Visitor,
    now: Time,
) -> db::Result<String> {
    let token = secret::new_token();
    execute!(
        &mut *tx,
        "DELETE FROM known_devices
         WHERE user_id = $1 AND (token_hash = $2 OR last_sign_in_at < $3)",
        user,
        visitor.device.as_deref(),
        Time(now.0.plus_seconds(-(KNOWN_FOR_S as f64)))
    )?;
    execute!(
        &mut *tx,
        "INSERT INTO known_devices (user_id, token_hash, last_sign_in_at) VALUES ($1, $2, $3)",
        user,
        secret::hash(&token),
        now
    )?;
    execute!(
        tx,
        "DELETE FROM known_devices
         WHERE user_id = $1 AND token_hash NOT IN
               (SELECT token_hash FROM known_devices WHERE user_id = $1
                ORDER BY last_sign_in_at DESC, token_hash LIMIT $2)",
        user,
        MOST
    )?;
    Ok(token)
}

/// Forgets the devices of a user whose access ended.
pub(crate) async fn forget_all(tx: &mut Tx, user: UserId) -> db::Result<()> {
    execute!(tx, "DELETE FROM known_devices WHERE user_id = $1", user).map(drop)
}

/// Returns the header that sets the cookie.
pub(super) fn set_cookie(app: &App, token: &str) -> HeaderValue {
    let config = &app.config;
    // Lax, so that it also comes with the return from a sign-in provider.
    cookie::header(config, name(config), token, KNOWN_FOR_S, SameSite::Lax)
}

fn name(config: &Serve) -> &'static str {
    if config.has_secure_cookies() {
        SECURE
    } else {
        PLAIN
    }
}
