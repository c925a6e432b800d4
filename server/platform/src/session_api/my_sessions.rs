//! Sessions and password of the signed-in user.

use crate::access::Caller;
use crate::app::App;
use crate::audit::RequestContext;
use crate::error::{Error, Problem, Result};
use crate::http::{Id, Json, Listed, Page, Valid};
use crate::ids::SessionId;
use crate::session::{self, Session};
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_sessions, end_other_sessions))
        .routes(routes!(end_session))
        .routes(routes!(change_password))
}

/// Page of sessions.
#[derive(Serialize, ToSchema)]
struct SessionList {
    /// Sessions in the order in which they were opened.
    items: Vec<Session>,
    /// Value of `after` for the next page.
    #[schema(required)]
    next: Option<String>,
}

/// Password change.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({
    "current": "seven gulls over the quay", "new": "a lantern astern at midnight"
}))]
struct ChangedPassword {
    /// Current password.
    #[schema(format = Password)]
    current: String,
    /// New password: at least 12 characters, neither common nor easily guessed.
    #[schema(format = Password)]
    new: String,
}

/// List your sessions
#[utoipa::path(get, path = "/sessions", tag = "session", params(Page),
    responses((status = 200, body = SessionList), (status = 401, body = Problem)))]
async fn list_sessions(
    State(app): State<App>,
    caller: Caller,
    page: Page,
) -> Result<Json<SessionList>> {
    let now = app.clock.now().into();
    let (user, idle_s) = (caller.user.user_id, app.idle_s());
    let found = session::list(&app.db, user, now, idle_s, page.after_id()?, page.fetch()).await?;
    let Listed { mut items, next } = page.cut(found, |session| session.id.to_string());
    for session in &mut items {
        session.current = caller.session == Some(session.id);
    }
    Ok(Json(SessionList { items, next }))
}

/// End one of your sessions
#[utoipa::path(delete, path = "/sessions/{id}", tag = "session", params(("id" = SessionId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem)))]
async fn end_session(
    request: RequestContext,
    caller: Caller,
    Id(id): Id<SessionId>,
) -> Result<StatusCode> {
    caller.must_be_signed_in()?;
    if !session::end(&request, caller.user.user_id, id).await? {
        return Err(Error::NotFound("session"));
    }
    Ok(StatusCode::NO_CONTENT)
}

/// End all your other sessions
#[utoipa::path(delete, path = "/sessions", tag = "session",
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem)))]
async fn end_other_sessions(request: RequestContext, caller: Caller) -> Result<StatusCode> {
    let session = caller.must_be_signed_in()?;
    let mut tx = request.begin().await?;
    session::end_all(&mut tx, caller.user.user_id, Some(session)).await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Change your password
///
/// All your other sessions end. API tokens stay valid.
#[utoipa::path(put, path = "/me/password", tag = "session", request_body = ChangedPassword,
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 422, body = Problem), (status = 429, body = Problem)))]
async fn change_password(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    Valid(change): Valid<ChangedPassword>,
) -> Result<StatusCode> {
    let session = caller.must_be_signed_in()?;
    let user = &caller.user;
    let is_the_same = change.new == change.current;
    session::confirm_password(&app, &request, user, session, change.current).await?;
    if is_the_same {
        return Err(Error::Invalid {
            field: "new",
            detail: "is your current password".to_owned(),
        });
    }
    let company = user.operator_name.as_ref().or(user.firm_name.as_ref());
    let about = [&user.email, &user.name, company.unwrap_or(&user.name)].map(String::as_str);
    let permit = app.hashing.acquire().await?;
    let hash = permit.hash_new("new", change.new, &about).await?;
    let mut tx = request.begin().await?;
    session::set_password(&mut tx, user.user_id, &hash).await?;
    session::end_all(&mut tx, user.user_id, Some(session)).await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}
