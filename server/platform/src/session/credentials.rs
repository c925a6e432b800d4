//! Password checks, and the start of sessions.

use super::device::Visitor;
use super::throttle::Subjects;
use super::user::User;
use super::{cookie, device, store, throttle};
use crate::app::App;
use crate::audit::{Refusal, RequestContext};
use crate::error::{Error, Result};
use crate::ids::SessionId;
use crate::{password, secret};
use axum::http::HeaderMap;
use axum::http::header::SET_COOKIE;

/// Opens a session after a check by a provider or by password. Returns the headers that set its
/// cookie and that of the device.
///
/// # Errors
/// Fails when the database fails.
pub async fn open(
    app: &App,
    request: &RequestContext,
    visitor: &Visitor,
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
    let subjects = Subjects::person(&app.db, &user.email, visitor).await?;
    let mut tx = request.begin().await?;
    subjects.forget(&mut tx).await?;
    store::open(&mut tx, user, &visitor.from, &new).await?;
    let known = device::remember(&mut tx, user.user_id, visitor, new.now).await?;
    tx.commit().await?;
    app.accepted.note(secret::hash(&token));
    let mut cookies = cookie::set(&app.config, &token, lasts_s);
    cookies.append(SET_COOKIE, device::set_cookie(app, &known));
    Ok(cookies)
}

/// Returns the user with an e-mail and a password.
///
/// # Errors
/// Fails when the password is wrong, or after too many failed attempts.
pub(crate) async fn check_password(
    app: &App,
    request: &RequestContext,
    subjects: &Subjects,
    email: &str,
    password: String,
) -> Result<User> {
    let now = app.clock.now();
    throttle::check(request, subjects, now).await?;
    if password.len() > password::MAX_BYTES {
        throttle::note_failure(request, subjects, Refusal::WrongPassword, now).await?;
        return Err(Error::WrongPassword);
    }
    let permit = app.hashing.acquire().await?;
    // Others may have failed while this attempt waited. Each holds its permit until its failure
    // is noted, so that simultaneous guesses cannot escape the count.
    throttle::check(request, subjects, now).await?;
    let found = store::find_by_email(&app.db, email).await?;
    let (user, stored) = found.map_or((None, None), |(user, hash)| (Some(user), Some(hash)));
    let (matches, permit) = permit.matches(password, stored).await?;
    if let Some(user) = user.filter(|_| matches) {
        return Ok(user);
    }
    throttle::note_failure(request, subjects, Refusal::WrongPassword, now).await?;
    drop(permit);
    Err(Error::WrongPassword)
}

/// Checks the password again before a change that nobody may make who merely finds an open
/// session.
///
/// # Errors
/// Fails when the password is wrong, which counts as a failed attempt of the session.
pub async fn confirm_password(
    app: &App,
    request: &RequestContext,
    user: &User,
    session: SessionId,
    password: String,
) -> Result<()> {
    let subjects = Subjects::session(session, &user.email);
    check_password(app, request, &subjects, &user.email, password)
        .await
        .map(drop)
}
