//! Password checks, and the start of sessions.

use super::throttle::Subjects;
use super::user::User;
use super::{cookie, store, throttle};
use crate::app::App;
use crate::audit::RequestContext;
use crate::client_address::Origin;
use crate::error::{Error, Result};
use crate::{password, secret};
use axum::http::HeaderMap;

/// Opens a session after a check by a provider or by password. Returns the header that sets its
/// cookie.
///
/// # Errors
/// Fails when the database fails.
pub async fn open(
    app: &App,
    request: &RequestContext,
    from: &Origin,
    user: &User,
    provider: Option<&str>,
) -> Result<HeaderMap> {
    let now = app.clock.now();
    let token = secret::new_token();
    let lasts_s = u64::from(app.config.session_hours) * 3600;
    let new = store::NewSession {
        token: &token,
        provider,
        now: now.into(),
        expires_at: now.plus_seconds(lasts_s as f64).into(),
    };
    store::open(request, user, from, &new).await?;
    Ok(cookie::set(&app.config, &token, lasts_s))
}

/// Returns the user with an e-mail and a password.
///
/// # Errors
/// Fails when the password is wrong, or after too many failed attempts.
pub(crate) async fn check_password(
    app: &App,
    request: &RequestContext,
    from: &Origin,
    email: &str,
    password: String,
) -> Result<User> {
    if password.len() > password::MAX_BYTES {
        return Err(Error::WrongPassword);
    }
    let now = app.clock.now();
    let subjects = Subjects::person(email, from);
    throttle::check(&app.db, &subjects, now).await?;
    let permit = app.hashing.acquire().await?;
    // Others may have failed while this attempt waited. Each holds its permit until its failure
    // is noted, so that simultaneous guesses cannot escape the count.
    throttle::check(&app.db, &subjects, now).await?;
    let found = store::find_by_email(&app.db, email).await?;
    let (user, stored) = found.map_or((None, None), |(user, hash)| (Some(user), Some(hash)));
    let (matches, permit) = permit.matches(password, stored).await?;
    if let Some(user) = user.filter(|_| matches) {
        return Ok(user);
    }
    throttle::note_failure(request, &subjects, now).await?;
    drop(permit);
    Err(Error::WrongPassword)
}

/// Checks the password again before a change that nobody may make who merely finds an open
/// session.
///
/// # Errors
/// Fails when the password is wrong, which counts as a failed sign-in.
pub async fn confirm_password(
    app: &App,
    request: &RequestContext,
    user: &User,
    from: &Origin,
    password: String,
) -> Result<()> {
    check_password(app, request, from, &user.email, password)
        .await
        .map(drop)
}
