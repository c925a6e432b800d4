//! Signing in and out.
//!
//! What always holds: the cookie carries a random token that is stored only as a
//! hash, ends when its time is over or the user signs out, and is not readable by
//! scripts.

mod store;
mod throttle;

pub use store::{Role, User, create_user, find_user, name_of};

use crate::access::Caller;
use crate::app::App;
use crate::error::{Error, Problem, Result};
use crate::http::{Json, Valid};
use crate::secret;
use axum::extract::State;
use axum::http::header::{HeaderValue, SET_COOKIE};
use axum::http::{HeaderMap, StatusCode};
use serde::Deserialize;
use tokio::sync::OwnedSemaphorePermit;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The session cookie's name.
pub const COOKIE: &str = "binnacle_session";
/// Argon2 takes any length; nobody types more.
const MAX_PASSWORD_BYTES: usize = 1024;

/// The routes of this part.
pub fn router() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(sign_in, sign_out))
        .routes(routes!(me))
}

/// What a user signs in with.
#[derive(Deserialize, ToSchema)]
pub struct SignIn {
    /// Without regard to case.
    #[schema(example = "captain@example.com")]
    pub email: String,
    /// As it was set.
    #[schema(format = Password)]
    pub password: String,
}

/// Sign in
///
/// Answers with a session cookie. After five wrong passwords for an e-mail, each
/// further attempt has to wait, longer every time.
#[utoipa::path(post, path = "/session", tag = "session", request_body = SignIn, security(()),
    responses((status = 200, body = User), (status = 401, body = Problem), (status = 429, body = Problem)))]
async fn sign_in(
    State(app): State<App>,
    Valid(request): Valid<SignIn>,
) -> Result<(HeaderMap, Json<User>)> {
    // PostgreSQL takes no NUL in a text, and nobody has such an e-mail.
    let unheard_of = request.email.chars().any(char::is_control);
    if unheard_of || request.password.len() > MAX_PASSWORD_BYTES {
        return Err(Error::WrongPassword);
    }
    let email = store::normal_email(&request.email);
    let now = app.clock.now();
    throttle::check(&app.db, &email, now).await?;
    let place = app
        .hashing
        .clone()
        .acquire_owned()
        .await
        .map_err(anyhow::Error::from)?;
    // Others may have failed while this attempt waited. Each keeps its place until
    // its failure is noted, so that guesses sent at once do not outrun the count.
    throttle::check(&app.db, &email, now).await?;
    let found = store::find_by_email(&app.db, &email).await?;
    let (user, stored) = found.map_or((None, None), |(user, hash)| (Some(user), Some(hash)));
    let (matches, place) = password_matches(place, request.password, stored).await?;
    let Some(user) = user.filter(|_| matches) else {
        throttle::note_failure(&app.db, &email, now).await?;
        drop(place);
        return Err(Error::WrongPassword);
    };
    let token = secret::new_token();
    let lasts_s = u64::from(app.config.session_hours) * 3600;
    let expires_at = now.plus_seconds(lasts_s as f64);
    store::open(
        &app.db,
        &user,
        &email,
        &token,
        now.into(),
        expires_at.into(),
    )
    .await?;
    Ok((set_cookie(&app, &token, lasts_s), Json(user)))
}

/// Sign out
///
/// The session ends for good, whoever holds its cookie.
#[utoipa::path(delete, path = "/session", tag = "session",
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem)))]
async fn sign_out(State(app): State<App>, caller: Caller) -> Result<(StatusCode, HeaderMap)> {
    if let Some(token) = &caller.session {
        store::close(&app.db, &secret::hash(token)).await?;
    }
    Ok((StatusCode::NO_CONTENT, set_cookie(&app, "", 0)))
}

/// Who is signed in
#[utoipa::path(get, path = "/me", tag = "session",
    responses((status = 200, body = User), (status = 401, body = Problem)))]
async fn me(caller: Caller) -> Json<User> {
    Json(caller.user)
}

/// Whether the password is right. The place goes along, so that it is taken for as
/// long as the hashing lasts, even when nobody waits for the answer any more.
async fn password_matches(
    place: OwnedSemaphorePermit,
    password: String,
    stored: Option<String>,
) -> Result<(bool, OwnedSemaphorePermit)> {
    let matches = tokio::task::spawn_blocking(move || {
        let matches = secret::password_matches(&password, stored.as_deref());
        (matches, place)
    });
    Ok(matches.await?)
}

fn set_cookie(app: &App, token: &str, max_age_s: u64) -> HeaderMap {
    let secure = if app.config.secure_cookies || app.config.tls_cert.is_some() {
        "; Secure"
    } else {
        ""
    };
    let cookie =
        format!("{COOKIE}={token}; Path=/; HttpOnly; SameSite=Strict; Max-Age={max_age_s}{secure}");
    let value = HeaderValue::try_from(cookie).expect("base64url and digits fit into a header");
    HeaderMap::from_iter([(SET_COOKIE, value)])
}
