//! Handlers of firms: creation, and engagement by operators.

use super::store::{self, Firm};
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_fleet::operators::{self, NewCompany};
use binnacle_platform::access::{Caller, Founder, Platform};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Valid, text};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{FirmId, OperatorId};
use binnacle_platform::quotas::Quota;
use binnacle_platform::session::Role;
use binnacle_platform::tenants::Tenant;
use binnacle_platform::users::{self, Invitation, NewCompanyUser};
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Quota of the firms that an operator enters.
pub const QUOTA: Quota = Quota::new("firms", "firms that you enter", 50, store::count);

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_firms, create_firm))
        .routes(routes!(find_firm))
        .routes(routes!(invite_adjuster))
        .routes(routes!(engage_firm, dismiss_firm))
}

/// Page of firms.
#[derive(Serialize, ToSchema)]
struct FirmList {
    /// Firms in the order of their creation.
    items: Vec<Firm>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// List the firms
///
/// Those that work for your operator; an adjuster's own; all for a platform admin.
#[utoipa::path(get, path = "/firms", tag = "adjusting", params(Page),
    responses((status = 200, body = FirmList), (status = 401, body = Problem)))]
async fn list_firms(State(app): State<App>, caller: Caller, page: Page) -> Result<Json<FirmList>> {
    caller.must_have_second_factor()?;
    let who = caller.tenant();
    let found = store::list(&app.db, who, page.after_id()?, page.fetch()).await?;
    let listed = page.cut(found, |firm| firm.id.to_string());
    Ok(Json(FirmList {
        items: listed.items,
        next: listed.next,
    }))
}

/// Create a firm
///
/// For platform admins, and for an operator's admin: then the firm works for that operator alone,
/// until a platform admin engages it for another.
#[utoipa::path(post, path = "/firms", tag = "platform", params(Key), request_body = NewCompany,
    responses((status = 201, body = Firm), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 409, description = "The quota is used up", body = Problem),
              (status = 422, body = Problem)))]
async fn create_firm(
    State(app): State<App>,
    request: RequestContext,
    founder: Founder,
    key: Key,
    Valid(new): Valid<NewCompany>,
) -> Result<(StatusCode, Json<Firm>)> {
    let request_hash = idempotency::request_hash("firm", &new)?;
    let name = text("name", &new.name)?;
    let now = app.clock.now().into();
    let wanted = FirmId::new();
    let mut tx = request.begin().await?;
    let made = key
        .once(&mut tx, founder.key_owner, &request_hash, wanted.0, now)
        .await?;
    if made == wanted.0 {
        if let Some(operator) = founder.operator {
            QUOTA.must_have_room(&mut tx, operator, now).await?;
        }
        store::insert(&mut tx, wanted, &name, founder.operator, now).await?;
        if let Some(operator) = founder.operator {
            store::engage(&mut tx, operator, wanted, now).await?;
        }
    }
    tx.commit().await?;
    let who = founder.operator.map(Tenant::Operator);
    Ok((StatusCode::CREATED, found(&app, who, FirmId(made)).await?))
}

/// Invite an adjuster of a firm
///
/// For platform admins, and for an admin of the operator that entered the firm while it works for
/// no other. In a session, not with a token.
#[utoipa::path(post, path = "/firms/{id}/users", tag = "adjusting",
    params(("id" = FirmId, Path)), request_body = NewCompanyUser,
    responses((status = 201, body = Invitation), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "The e-mail address already has an account", body = Problem),
              (status = 422, body = Problem)))]
async fn invite_adjuster(
    State(app): State<App>,
    request: RequestContext,
    founder: Founder,
    Id(id): Id<FirmId>,
    Valid(new): Valid<NewCompanyUser>,
) -> Result<(StatusCode, Json<Invitation>)> {
    founder.must_be_in_person()?;
    let who = founder.operator.map(Tenant::Operator);
    let firm = store::find(&app.db, who, id).await?;
    if founder.operator.is_some() && !firm.as_ref().is_some_and(|firm| firm.is_own) {
        let shared = "only a platform admin invites users of a firm that is not yours alone";
        return Err(Error::Forbidden(shared));
    }
    if firm.is_none() {
        return Err(Error::NotFound("firm"));
    }
    let invited = users::invite(&app, &request, &new, id.into(), Role::Adjuster).await?;
    Ok((StatusCode::CREATED, Json(invited)))
}

/// See a firm
#[utoipa::path(get, path = "/firms/{id}", tag = "adjusting", params(("id" = FirmId, Path)),
    responses((status = 200, body = Firm), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_firm(
    State(app): State<App>,
    caller: Caller,
    Id(id): Id<FirmId>,
) -> Result<Json<Firm>> {
    caller.must_have_second_factor()?;
    found(&app, caller.tenant(), id).await
}

async fn found(app: &App, who: Option<Tenant>, id: FirmId) -> Result<Json<Firm>> {
    let firm = store::find(&app.db, who, id).await?;
    Ok(Json(firm.ok_or(Error::NotFound("firm"))?))
}

/// Engage a firm for an operator
///
/// For platform admins. From then on the operator may offer its orders to the firm.
#[utoipa::path(put, path = "/operators/{id}/firms/{firm}", tag = "platform",
    params(("id" = OperatorId, Path), ("firm" = FirmId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem)))]
async fn engage_firm(
    State(app): State<App>,
    request: RequestContext,
    admin: Platform,
    Id((operator, firm)): Id<(OperatorId, FirmId)>,
) -> Result<StatusCode> {
    admin.must_be_writer()?;
    let mut tx = request.begin().await?;
    if !operators::exists(&mut tx, operator).await? {
        return Err(Error::NotFound("operator"));
    }
    if !store::exists(&mut tx, firm).await? {
        return Err(Error::NotFound("firm"));
    }
    store::engage(&mut tx, operator, firm, app.clock.now().into()).await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// End a firm's engagement by an operator
///
/// For platform admins. Not while the firm has an open offer or an unfinished order of the
/// operator: those are cancelled or given back first.
#[utoipa::path(delete, path = "/operators/{id}/firms/{firm}", tag = "platform",
    params(("id" = OperatorId, Path), ("firm" = FirmId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem),
              (status = 409, description = "It has an open offer or an order", body = Problem)))]
async fn dismiss_firm(
    request: RequestContext,
    admin: Platform,
    Id((operator, firm)): Id<(OperatorId, FirmId)>,
) -> Result<StatusCode> {
    admin.must_be_writer()?;
    let mut tx = request.begin().await?;
    let orders = store::count_open_orders(&mut tx, operator, firm).await?;
    if !store::dismiss(&mut tx, operator, firm).await? {
        return Err(Error::NotFound("firm"));
    }
    if orders > 0 {
        let open_orders = match orders {
            1 => "one order is".to_owned(),
            more => format!("{more} orders are"),
        };
        return Err(Error::WrongState(format!(
            "{open_orders} still open with the firm (offered or accepted): cancel first, or \
             ask the firm to return what it has"
        )));
    }
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}
