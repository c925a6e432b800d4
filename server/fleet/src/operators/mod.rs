//! Operators: companies with a fleet, each a tenant.
//!
//! Invariant: only a platform admin sees that there are others.

mod first_run;
mod store;

pub use first_run::make_code as make_first_run_code;
pub use store::{all, create, exists};

use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::Platform;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Valid, text};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::OperatorId;
use binnacle_platform::session::Role;
use binnacle_platform::users::{self, Invitation, NewCompanyUser};
use serde::{Deserialize, Serialize};
use store::Operator;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_operators, create_operator))
        .routes(routes!(find_operator))
        .routes(routes!(invite_admin))
        .merge(first_run::router())
}

/// A company to be entered.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({ "name": "Armada del Sur" }))]
pub struct NewCompany {
    /// Its name.
    #[schema(min_length = 1, max_length = 200)]
    pub name: String,
}

/// A page of operators.
#[derive(Serialize, ToSchema)]
struct OperatorList {
    /// In the order in which they were entered.
    items: Vec<Operator>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// List the operators
///
/// For platform admins.
#[utoipa::path(get, path = "/operators", tag = "platform", params(Page),
    responses((status = 200, body = OperatorList), (status = 401, body = Problem),
              (status = 403, body = Problem)))]
async fn list_operators(
    State(app): State<App>,
    _admin: Platform,
    page: Page,
) -> Result<Json<OperatorList>> {
    let found = store::list(&app.db, page.after_id()?, page.fetch()).await?;
    let listed = page.cut(found, |operator| operator.id.to_string());
    Ok(Json(OperatorList {
        items: listed.items,
        next: listed.next,
    }))
}

/// Enter an operator
///
/// For platform admins, who then invite its first admin.
#[utoipa::path(post, path = "/operators", tag = "platform", params(Key),
    request_body = NewCompany,
    responses((status = 201, body = Operator), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem)))]
async fn create_operator(
    State(app): State<App>,
    request: RequestContext,
    admin: Platform,
    key: Key,
    Valid(new): Valid<NewCompany>,
) -> Result<(StatusCode, Json<Operator>)> {
    let admin = admin.must_be_writer()?;
    let request_hash = idempotency::request_hash("operator", &new)?;
    let name = text("name", &new.name)?;
    let now = app.clock.now().into();
    let new_id = OperatorId::new();
    let mut tx = request.begin().await?;
    let made = key
        .once(&mut tx, admin, &request_hash, new_id.0, now)
        .await?;
    if made == new_id.0 {
        store::insert(&mut tx, new_id, &name, now).await?;
    }
    tx.commit().await?;
    Ok((StatusCode::CREATED, found(&app, OperatorId(made)).await?))
}

/// See an operator
///
/// For platform admins.
#[utoipa::path(get, path = "/operators/{id}", tag = "platform",
    params(("id" = OperatorId, Path)),
    responses((status = 200, body = Operator), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem)))]
async fn find_operator(
    State(app): State<App>,
    _admin: Platform,
    Id(id): Id<OperatorId>,
) -> Result<Json<Operator>> {
    found(&app, id).await
}

/// Invite an operator's first admin
///
/// For platform admins in a session. The admin invites the operator's other users.
#[utoipa::path(post, path = "/operators/{id}/users", tag = "platform",
    params(("id" = OperatorId, Path)), request_body = NewCompanyUser,
    responses((status = 201, body = Invitation), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "The e-mail address already has an account", body = Problem),
              (status = 422, body = Problem)))]
async fn invite_admin(
    State(app): State<App>,
    request: RequestContext,
    admin: Platform,
    Id(id): Id<OperatorId>,
    Valid(new): Valid<NewCompanyUser>,
) -> Result<(StatusCode, Json<Invitation>)> {
    admin.must_be_in_person()?;
    let _operator = found(&app, id).await?;
    let invited = users::invite(&app, &request, &new, id.into(), Role::Admin).await?;
    Ok((StatusCode::CREATED, Json(invited)))
}

async fn found(app: &App, id: OperatorId) -> Result<Json<Operator>> {
    let operator = store::find(&app.db, id).await?;
    Ok(Json(operator.ok_or(Error::NotFound("operator"))?))
}
