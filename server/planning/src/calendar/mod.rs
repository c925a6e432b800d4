//! Calendars: work orders, port calls and due dates where people keep their appointments
//! (RFC 5545).
//!
//! What always holds: a feed's address is its secret, shown once and stored as a hash; it
//! shows what its operator or firm sees now, and nothing once it, or who made it, is
//! removed. Port calls and due dates are the operator's own: no firm's calendar has them.

mod feed;
mod ics;
mod store;
mod subscriber;

pub use subscriber::delete_feeds;

use axum::extract::{FromRef, FromRequestParts, State};
use axum::http::StatusCode;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::http::request::Parts;
use axum::response::{IntoResponse, Response};
use binnacle_fleet::vessels;
use binnacle_platform::access::{PartyReader, PartyWriter};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Listed, Page, Params, Valid, text};
use binnacle_platform::ids::{FeedId, VesselId};
use binnacle_platform::secret;
use binnacle_platform::session;
use binnacle_platform::tenants::Tenant;
use feed::{Feed, Scope};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Prefix of a feed's token.
const PREFIX: &str = "bnc_";

/// The routes of this part.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_feeds, create_feed))
        .routes(routes!(delete_feed))
        .routes(routes!(calendar))
}

/// A calendar to be made.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewCalendarFeed, example = json!({ "name": "Our fleet" }))]
struct NewFeed {
    /// Name of the feed.
    #[schema(min_length = 1, max_length = 200)]
    name: String,
    /// One of your vessels only, for an operator.
    #[serde(default)]
    vessel_id: Option<VesselId>,
}

/// A calendar just made.
#[derive(Serialize, ToSchema)]
#[schema(as = MadeCalendarFeed)]
struct MadeFeed {
    #[serde(flatten)]
    about: Feed,
    /// The address to subscribe to: whoever has it reads the calendar. Never shown again.
    #[schema(example = "https://binnacle.example.com/api/v1/calendar.ics?token=bnc_mZ3q8k…")]
    url: String,
}

/// A page of calendars.
#[derive(Serialize, ToSchema)]
#[schema(as = CalendarFeedList)]
struct FeedList {
    /// In the order in which they were made.
    items: Vec<Feed>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// List your calendars
#[utoipa::path(get, path = "/calendar-feeds", tag = "adjusting", params(Page),
    responses((status = 200, body = FeedList), (status = 401, body = Problem)))]
async fn list_feeds(
    State(app): State<App>,
    reader: PartyReader,
    page: Page,
) -> Result<Json<FeedList>> {
    let found = store::list(&app.db, reader.tenant, page.after_id()?, page.fetch()).await?;
    let Listed { items, next } = page.cut(found, |feed| feed.id.to_string());
    Ok(Json(FeedList { items, next }))
}

/// Make a calendar
///
/// Of all your work orders, or of one vessel's; for an operator with port calls and due
/// dates. The answer shows its secret address, this once. It ends when you are removed, shut
/// out or given another one-time code.
#[utoipa::path(post, path = "/calendar-feeds", tag = "adjusting", request_body = NewFeed,
    responses((status = 201, body = MadeFeed), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "The vessel is none of yours", body = Problem),
              (status = 422, body = Problem)))]
async fn create_feed(
    State(app): State<App>,
    request: RequestContext,
    writer: PartyWriter,
    Valid(new): Valid<NewFeed>,
) -> Result<(StatusCode, Json<MadeFeed>)> {
    let name = text("name", &new.name)?;
    if let Some(vessel) = new.vessel_id {
        let Tenant::Operator(operator) = writer.tenant else {
            return Err(Error::NotFound("vessel"));
        };
        vessels::must_be_in_fleet(&app.db, operator, vessel).await?;
    }
    let token = format!("{PREFIX}{}", secret::new_token());
    let mut tx = request.begin().await?;
    let about = Feed {
        id: FeedId::new(),
        name,
        vessel_id: new.vessel_id,
        created_at: app.clock.now().into(),
        created_by: session::name_of(&mut tx, writer.user).await?,
    };
    let hash = secret::hash(&token);
    store::insert(&mut tx, writer.tenant, writer.user, &about, &hash).await?;
    tx.commit().await?;
    let base = app.config.mail.public_url.as_deref().unwrap_or_default();
    let base = base.trim_end_matches('/');
    let url = format!("{base}/api/v1/calendar.ics?token={token}");
    Ok((StatusCode::CREATED, Json(MadeFeed { about, url })))
}

/// Remove a calendar
///
/// Its address shows nothing from now on.
#[utoipa::path(delete, path = "/calendar-feeds/{id}", tag = "adjusting",
    params(("id" = FeedId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem)))]
async fn delete_feed(
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<FeedId>,
) -> Result<StatusCode> {
    let mut tx = request.begin().await?;
    if !store::delete(&mut tx, writer.tenant, id).await? {
        return Err(Error::NotFound("calendar"));
    }
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// By which address a calendar is read.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Address {
    /// The secret of a calendar; without it, the caller's own orders.
    token: Option<String>,
}

impl<S> FromRequestParts<S> for Scope
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Scope> {
        let Params(address) = Params::<Address>::from_request_parts(parts, state).await?;
        if let Some(token) = address.token {
            let app = App::from_ref(state);
            let found = store::find(&app.db, &secret::hash(&token)).await?;
            return found.ok_or(Error::Unauthenticated);
        }
        let reader = PartyReader::from_request_parts(parts, state).await?;
        Ok(Scope {
            name: "Binnacle".to_owned(),
            tenant: reader.tenant,
            vessel: None,
        })
    }
}

/// Read a calendar
///
/// iCalendar (RFC 5545), by a calendar's secret address or as any other route. Of work
/// orders what is offered or planned is tentative, what a firm has is confirmed. An
/// operator's calendar has port calls too, and each compass's due date as a day, as it was
/// looked at within the last quarter of an hour. Each event keeps its `UID`, and its
/// `SEQUENCE` grows; what is cancelled or withdrawn stays for a season and says so.
#[utoipa::path(get, path = "/calendar.ics", tag = "adjusting", params(Address),
    responses((status = 200, content_type = "text/calendar", body = String),
              (status = 401, body = Problem)))]
async fn calendar(State(app): State<App>, scope: Scope) -> Result<Response> {
    let now = app.clock.now().into();
    let found = store::appointments(&app.db, scope.tenant, scope.vessel, now).await?;
    let (calls, due) = match scope.tenant {
        Tenant::Firm(_) => (Vec::new(), Vec::new()),
        Tenant::Operator(operator) => (
            store::calls(&app.db, operator, scope.vessel, now).await?,
            store::due_dates(&app.db, operator, scope.vessel).await?,
        ),
    };
    let public_url = app.config.mail.public_url.as_deref();
    let events = ics::orders(&found, public_url)?
        .chain(ics::calls(&calls)?)
        .chain(ics::due_dates(&due, public_url)?);
    let text = ics::write(&scope.name, events);
    let headers = [
        (CONTENT_TYPE, "text/calendar; charset=utf-8"),
        (CACHE_CONTROL, "private, max-age=300"),
    ];
    Ok((headers, text).into_response())
}
