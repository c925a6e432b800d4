//! Sign-in by password, and sign-out.

use crate::access::Caller;
use crate::app::App;
use crate::audit::{Refusal, RequestContext};
use crate::error::{Error, Problem, Result};
use crate::http::{Json, Valid};
use crate::second_factor;
use crate::session::throttle::{self, Subjects};
use crate::session::{self, User, Visitor, cookie, normal_email};
use axum::extract::{FromRef, State};
use axum::http::{HeaderMap, StatusCode};
use serde::Deserialize;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(sign_in, sign_out))
        .routes(routes!(me))
}

/// Credentials of a user.
#[derive(Deserialize, ToSchema)]
#[schema(example = json!({ "email": "captain@example.com", "password": "seven gulls over the quay" }))]
struct SignIn {
    /// E-mail address, case-insensitive.
    email: String,
    /// Password.
    #[schema(format = Password)]
    password: String,
    /// Code of the authenticator app, or a recovery code; only for users with a second factor.
    code: Option<String>,
}

/// Sign in
///
/// The response sets a session cookie. A user with a second factor who sends no code gets
/// `second-factor-needed` if the password is right, and repeats the request with the code.
/// After five wrong passwords or codes for an e-mail address, each further attempt has to wait,
/// longer every time. The same holds after fifty from one network address. A browser in which the
/// user signed in before, which a second cookie tells, is counted by itself.
#[utoipa::path(post, path = "/session", tag = "session", request_body = SignIn, security(()),
    responses((status = 200, body = User), (status = 401, body = Problem), (status = 429, body = Problem)))]
async fn sign_in(
    State(app): State<App>,
    request: RequestContext,
    visitor: Visitor,
    Valid(given): Valid<SignIn>,
) -> Result<(HeaderMap, Json<User>)> {
    let user = authenticate(&app, &request, &visitor, given).await?;
    Ok((
        session::open(&app, &request, &visitor, &user, None).await?,
        Json(user),
    ))
}

/// Sign out
///
/// The session ends permanently, whoever holds its cookie.
#[utoipa::path(delete, path = "/session", tag = "session",
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem)))]
async fn sign_out(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
) -> Result<(StatusCode, HeaderMap)> {
    if let Some(session) = caller.session {
        session::end(&request, caller.user.user_id, session).await?;
    }
    Ok((StatusCode::NO_CONTENT, cookie::set(&app.config, "", 0)))
}

/// Show the signed-in user
#[utoipa::path(get, path = "/me", tag = "session",
    responses((status = 200, body = User), (status = 401, body = Problem)))]
async fn me(caller: Caller) -> Json<User> {
    Json(caller.user)
}

/// Returns the user if password and code are right.
async fn authenticate(
    app: &App,
    request: &RequestContext,
    visitor: &Visitor,
    given: SignIn,
) -> Result<User> {
    // PostgreSQL accepts no NUL in a text, and nobody has such an e-mail address.
    if given.email.chars().any(char::is_control) {
        let (subjects, now) = (Subjects::address(&visitor.from), app.clock.now());
        throttle::check(request, &subjects, now).await?;
        throttle::note_failure(request, &subjects, Refusal::WrongPassword, now).await?;
        return Err(Error::WrongPassword);
    }
    let email = normal_email(&given.email);
    let subjects = Subjects::person(&app.db, &email, visitor).await?;
    let user = session::check_password(app, request, &subjects, &email, given.password).await?;
    request.record_actor(&user);
    if !user.second_factor {
        return Ok(user);
    }
    let code = given.code.filter(|code| !code.trim().is_empty());
    let code = code.ok_or(Error::SecondFactorNeeded)?;
    let now = app.clock.now();
    if second_factor::use_code(request, user.user_id, &code, now).await? {
        return Ok(user);
    }
    throttle::note_failure(request, &subjects, Refusal::WrongCode, now).await?;
    Err(Error::WrongCode)
}
