//! Routes to the provider, back from it, and through the second factor.

use super::attempt::{self, Attempt};
use super::claims::{self, Identity};
use super::refusal::Refusal;
use super::store::{self, BoundUser};
use crate::app::App;
use crate::audit::{self, RequestContext};
use crate::error::{Error, Problem, Result};
use crate::http::{Json, Params, Valid};
use crate::session::throttle::{self, Subjects};
use crate::session::{self, User, Visitor, normal_email};
use crate::time::Time;
use crate::{second_factor, secret};
use axum::extract::{FromRef, State};
use axum::http::header::{LOCATION, SET_COOKIE};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};
use tracing::info;
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Address of the sign-in page, to which the outcome is appended.
const SIGN_IN_PAGE: &str = "/?sign-in=";

/// Routes of the sign-in through a provider.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(find_provider))
        .routes(routes!(go_to_provider))
        .routes(routes!(return_from_provider))
        .routes(routes!(send_code))
}

/// Provider through which users may sign in.
#[derive(Serialize, ToSchema)]
#[schema(as = SignInProvider, example = json!({ "name": "Example Lines" }))]
struct ProviderName {
    /// Name of the provider; none if no provider is set up.
    #[schema(required)]
    name: Option<String>,
}

/// Query parameters of the provider's redirect.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct CallbackQuery {
    /// Code that stands for the signed-in person.
    code: Option<String>,
    /// State value, as it was sent.
    state: Option<String>,
    /// Error code, if nobody signed in.
    error: Option<String>,
}

/// Code of a second factor.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = ProviderCode, example = json!({ "code": "287082" }))]
struct Code {
    /// Code of the authenticator app, or a recovery code.
    code: String,
}

/// Show the sign-in provider
///
/// This is the OpenID Connect provider, if one is set up on this server.
#[utoipa::path(get, path = "/session/provider", tag = "session", security(()),
    responses((status = 200, body = ProviderName)))]
async fn find_provider(State(app): State<App>) -> Json<ProviderName> {
    let config = &app.config.oidc;
    let name = config.is_set_up().then(|| config.oidc_name.clone());
    Json(ProviderName { name })
}

/// Go to the provider to sign in
///
/// For browsers. The provider redirects them to `/session/provider/callback`. While the
/// provider cannot be reached, they are redirected to the sign-in page, which shows the reason.
#[utoipa::path(get, path = "/session/provider/start", tag = "session", security(()),
    responses((status = 303, description = "To the provider, or to the sign-in page"),
              (status = 409, description = "No provider is set up", body = Problem)))]
async fn go_to_provider(State(app): State<App>) -> Result<(StatusCode, HeaderMap)> {
    must_be_set_up(&app)?;
    let attempt = Attempt::new(&app);
    let address = match claims::current(&app).await {
        Ok(found) => claims::address(&app, &found, &attempt),
        Err(refusal) => Err(refusal),
    };
    Ok(match address {
        Ok(address) => redirect(address.as_str(), [attempt.set_cookie(&app.config)]),
        Err(refusal) => redirect_to_sign_in_page(&app, &refusal),
    })
}

/// Return from the provider
///
/// A signed-in browser is redirected to the dashboard. Otherwise it is redirected to the
/// sign-in page, which asks for the second factor or shows the reason.
#[utoipa::path(get, path = "/session/provider/callback", tag = "session", params(CallbackQuery),
    security(()),
    responses((status = 303, description = "To the dashboard, or to the sign-in page"),
              (status = 409, description = "No provider is set up", body = Problem)))]
async fn return_from_provider(
    State(app): State<App>,
    request: RequestContext,
    visitor: Visitor,
    headers: HeaderMap,
    Params(query): Params<CallbackQuery>,
) -> Result<(StatusCode, HeaderMap)> {
    // A return from the provider signs somebody in.
    request.log_as_change();
    must_be_set_up(&app)?;
    Ok(
        match conclude(&app, &request, &visitor, &headers, query).await {
            Ok(done) => done,
            Err(refusal) => {
                info!(why = refusal.word(), "nobody was signed in by the provider");
                redirect_to_sign_in_page(&app, &refusal)
            }
        },
    )
}

/// Send the second factor's code after the provider
///
/// For users with a second factor, in the browser that returned from the provider.
#[utoipa::path(post, path = "/session/provider/code", tag = "session", security(()),
    request_body = Code,
    responses((status = 200, body = User), (status = 401, body = Problem),
              (status = 410, description = "The sign-in took too long", body = Problem),
              (status = 429, body = Problem)))]
async fn send_code(
    State(app): State<App>,
    request: RequestContext,
    visitor: Visitor,
    headers: HeaderMap,
    Valid(sent): Valid<Code>,
) -> Result<(HeaderMap, Json<User>)> {
    const OVER: Error = Error::Gone("this sign-in took too long; start again");
    let attempt = Attempt::from_headers(&app, &headers).ok_or(OVER)?;
    let (state, now) = (attempt.state_hash(), app.clock.now());
    let user = store::awaited(&app.db, &state, now.into()).await?;
    let user = user.ok_or(OVER)?;
    request.record_actor(&user);
    let subjects = Subjects::person(&app.db, &user.email, &visitor).await?;
    // As with passwords, simultaneous guesses must not escape the count.
    let _permit = app.hashing.acquire().await?;
    throttle::check(&request, &subjects, now).await?;
    if !second_factor::use_code(&request, user.user_id, &sent.code, now).await? {
        throttle::note_failure(&request, &subjects, audit::Refusal::WrongCode, now).await?;
        return Err(Error::WrongCode);
    }
    if !store::take_awaited(&request, &state).await? {
        return Err(OVER);
    }
    let mut cookies = open(&app, &request, &visitor, &user).await?;
    cookies.append(SET_COOKIE, attempt::clear_cookie(&app.config));
    Ok((cookies, Json(user)))
}

fn must_be_set_up(app: &App) -> Result<()> {
    if app.config.oidc.is_set_up() {
        return Ok(());
    }
    Err(Error::NotSetUp(
        "no sign-in provider is set up on this server",
    ))
}

type Concluded = std::result::Result<(StatusCode, HeaderMap), Refusal>;

async fn conclude(
    app: &App,
    request: &RequestContext,
    visitor: &Visitor,
    headers: &HeaderMap,
    query: CallbackQuery,
) -> Concluded {
    let attempt = Attempt::from_headers(app, headers).ok_or(Refusal::Over)?;
    // Hashes are compared, so that the timing does not reveal how much is right.
    let state = query.state.unwrap_or_default();
    if secret::hash(&state) != attempt.state_hash() {
        return Err(Refusal::Over);
    }
    let now = app.clock.now();
    let subjects = Subjects::address(&visitor.from);
    throttle::check(request, &subjects, now).await?;
    let until = Timestamp::from_micros(attempt.ends_s() * 1_000_000).unwrap_or(now);
    if !store::note_return(request, &attempt.state_hash(), now.into(), until.into()).await? {
        return Err(Refusal::Over);
    }
    let (None, Some(code)) = (query.error, query.code) else {
        return Err(Refusal::Cancelled);
    };
    let user = match identify(app, request, &attempt, code).await {
        Ok(user) => user,
        Err(refusal) => {
            if refusal.counts() {
                throttle::note_failure(request, &subjects, audit::Refusal::Provider, now).await?;
            }
            return Err(refusal);
        }
    };
    if user.second_factor {
        store::await_code(request, &attempt.state_hash(), user.user_id).await?;
        return Ok(redirect(&format!("{SIGN_IN_PAGE}code"), []));
    }
    let mut cookies = open(app, request, visitor, &user).await?;
    cookies.append(SET_COOKIE, attempt::clear_cookie(&app.config));
    cookies.insert(LOCATION, HeaderValue::from_static("/"));
    Ok((StatusCode::SEE_OTHER, cookies))
}

/// Returns the user whom the provider identifies.
async fn identify(
    app: &App,
    request: &RequestContext,
    attempt: &Attempt,
    code: String,
) -> std::result::Result<User, Refusal> {
    let issuer = claims::issuer(app);
    let identity = claims::redeem(app, attempt, code).await?;
    let subject = identity.subject.as_str();
    // PostgreSQL accepts no NUL in a text, and no provider uses one in a name.
    if subject.chars().any(char::is_control) {
        return Err(Refusal::Untrusted);
    }
    let user = match store::find_bound_user(&app.db, issuer, subject).await? {
        Some(BoundUser::User(user)) => *user,
        Some(BoundUser::Disabled) => return Err(Refusal::Unknown),
        None => return bind_first_sign_in(app, request, issuer, &identity).await,
    };
    request.record_actor(&user);
    Ok(user)
}

/// Binds a person who signs in for the first time to the user with the same e-mail address.
async fn bind_first_sign_in(
    app: &App,
    request: &RequestContext,
    issuer: &str,
    identity: &Identity,
) -> std::result::Result<User, Refusal> {
    let email = claims::verified_email(app, identity).await?;
    // No user has a non-ASCII address, and lower-casing could make different addresses alike.
    if !email.is_ascii() || email.chars().any(char::is_control) {
        return Err(Refusal::Unknown);
    }
    let user = store::find_by_email(&app.db, &normal_email(&email)).await?;
    let user = user.ok_or(Refusal::Unknown)?;
    let (subject, now) = (identity.subject.as_str(), Time(app.clock.now()));
    let mut tx = request.begin().await?;
    if store::bind(&mut tx, issuer, subject, user.user_id, now).await? {
        request.record_actor(&user);
        tx.commit().await?;
        return Ok(user);
    }
    drop(tx);
    // The same person may have signed in through two windows at once.
    match store::find_bound_user(&app.db, issuer, subject).await? {
        Some(BoundUser::User(known)) if known.user_id == user.user_id => {
            request.record_actor(&user);
            Ok(user)
        }
        _ => Err(Refusal::Taken),
    }
}

async fn open(
    app: &App,
    request: &RequestContext,
    visitor: &Visitor,
    user: &User,
) -> Result<HeaderMap> {
    session::open(
        app,
        request,
        visitor,
        user,
        Some(&app.config.oidc.oidc_name),
    )
    .await
}

/// Redirects to the sign-in page, which shows the reason.
fn redirect_to_sign_in_page(app: &App, refusal: &Refusal) -> (StatusCode, HeaderMap) {
    let page = format!("{SIGN_IN_PAGE}{}", refusal.word());
    redirect(&page, [attempt::clear_cookie(&app.config)])
}

fn redirect<const N: usize>(to: &str, cookies: [HeaderValue; N]) -> (StatusCode, HeaderMap) {
    let mut headers: HeaderMap = cookies
        .map(|cookie| (SET_COOKIE, cookie))
        .into_iter()
        .collect();
    if let Ok(to) = HeaderValue::try_from(to) {
        headers.insert(LOCATION, to);
    }
    (StatusCode::SEE_OTHER, headers)
}
