//! API that lists, creates and revokes the API tokens of the signed-in user.

use crate::access::Caller;
use crate::app::App;
use crate::audit::RequestContext;
use crate::error::{Error, Problem, Result};
use crate::http::{Id, Json, Listed, Page, Params, Valid};
use crate::idempotency::{self, Key};
use crate::ids::TokenId;
use crate::secret;
use crate::time::Time;
use crate::tokens::{self, PREFIX, Scope, Token};
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_tokens, create_token))
        .routes(routes!(delete_token))
}

const DAY_S: f64 = 86_400.0;
/// Life of a token for which nothing else is asked, days.
const DAYS_BY_DEFAULT: u32 = 365;

/// Token to be created.
#[derive(Serialize, Deserialize, ToSchema)]
#[schema(example = json!({ "name": "Office system", "scope": "write" }))]
struct NewToken {
    /// Purpose of the token.
    #[schema(min_length = 1, max_length = 200)]
    name: String,
    /// Scope of the token.
    scope: Scope,
    /// Expiry time, at most a year from now unless the server is set up otherwise; the latest one
    /// within a year by default.
    expires_at: Option<Time>,
}

/// Extent of a revocation.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Revocation {
    /// `true` to remove what was made with the token too.
    with_made: Option<bool>,
}

/// Newly created token.
#[derive(Serialize, ToSchema)]
struct MadeToken {
    /// Token.
    #[serde(flatten)]
    about: Token,
    /// Secret, to be sent as `Authorization: Bearer …`; never shown again.
    token: String,
}

/// Page of tokens.
#[derive(Serialize, ToSchema)]
struct TokenList {
    /// Tokens in the order in which they were created.
    items: Vec<Token>,
    /// Value of `after` for the next page.
    #[schema(required)]
    next: Option<String>,
}

/// List your API tokens
#[utoipa::path(get, path = "/tokens", tag = "session", params(Page),
    responses((status = 200, body = TokenList), (status = 401, body = Problem)))]
async fn list_tokens(
    State(app): State<App>,
    caller: Caller,
    page: Page,
) -> Result<Json<TokenList>> {
    let user = caller.user.user_id;
    let found = tokens::list(&app.db, user, page.after_id()?, page.fetch()).await?;
    let Listed { mut items, next } = page.cut(found, |token| token.id.to_string());
    let made = tokens::list_made(&app.db, user).await?;
    for token in &mut items {
        let own = made.iter().filter(|(by, _)| *by == token.id);
        token.made = own.map(|(_, made)| made.clone()).collect();
    }
    Ok(Json(TokenList { items, next }))
}

/// Create an API token
#[utoipa::path(post, path = "/tokens", tag = "session", params(Key), request_body = NewToken,
    responses((status = 201, body = MadeToken), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 409, description = "Made before", body = Problem),
              (status = 422, body = Problem)))]
async fn create_token(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    key: Key,
    Valid(new): Valid<NewToken>,
) -> Result<(StatusCode, Json<MadeToken>)> {
    // A leaked token must not create others that outlive it.
    caller.must_be_signed_in()?;
    caller.must_have_second_factor()?;
    let user = caller.user.user_id;
    let request_hash = idempotency::request_hash(&format!("token of {user}"), &new)?;
    let name = crate::http::text("name", &new.name)?;
    let now = app.clock.now();
    let days = app.config.token_days.min(DAYS_BY_DEFAULT);
    let expires_at = new
        .expires_at
        .unwrap_or_else(|| Time(now.plus_seconds(f64::from(days) * DAY_S)));
    check_expiry(expires_at, now, app.config.token_days)?;
    let token = format!("{PREFIX}{}", secret::new_token());
    let about = Token {
        id: TokenId::new(),
        name,
        scope: new.scope,
        expires_at,
        created_at: now.into(),
        last_used_at: None,
        made: Vec::new(),
    };
    let mut tx = request.begin().await?;
    key.shown_once(&mut tx, caller.key_owner(), &request_hash, now.into())
        .await?;
    if let Some(tenant) = caller.tenant() {
        tokens::QUOTA
            .must_have_room(&mut tx, tenant, now.into())
            .await?;
    }
    tokens::insert(&mut tx, user, &about, &secret::hash(&token)).await?;
    tx.commit().await?;
    app.accepted.note(secret::hash(&token));
    Ok((StatusCode::CREATED, Json(MadeToken { about, token })))
}

fn check_expiry(expires_at: Time, now: Timestamp, most_days: u32) -> Result<()> {
    let last = now.plus_seconds(f64::from(most_days) * DAY_S);
    let detail = if expires_at.0 <= now {
        format!("{} is in the past", expires_at.0)
    } else if expires_at.0 > last {
        format!("{} is more than {most_days} days from now", expires_at.0)
    } else {
        return Ok(());
    };
    Err(Error::Invalid {
        field: "expires_at",
        detail,
    })
}

/// Revoke an API token
///
/// Things made with it stay, unless you say otherwise. To remove them takes a session, and the role
/// that may make such things.
#[utoipa::path(delete, path = "/tokens/{id}", tag = "session",
    params(("id" = TokenId, Path), Revocation),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem)))]
async fn delete_token(
    request: RequestContext,
    caller: Caller,
    Id(id): Id<TokenId>,
    Params(revocation): Params<Revocation>,
) -> Result<StatusCode> {
    caller.must_not_only_read()?;
    let with_made = revocation.with_made == Some(true);
    if with_made {
        caller.must_be_signed_in()?;
        caller.must_change_shared()?;
    }
    let user = caller.user.user_id;
    let mut tx = request.begin().await?;
    if with_made {
        tokens::delete_with_made(&mut tx, user, id).await?;
    } else {
        tokens::delete(&mut tx, user, id).await?;
    }
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}
