//! Calendar feeds of work orders, port calls and due dates (RFC 5545).
//!
//! Invariants: a feed's address is its secret, shown once and stored as a hash. The feed shows
//! what its operator or firm sees now, and nothing once the feed or its creator is removed. Port
//! calls and due dates are in the operator's feeds only.

mod feed;
mod ics;
mod store;
mod subscriber;

pub use subscriber::{delete_feeds, delete_made, list_made};

use axum::extract::{FromRef, FromRequestParts, State};
use axum::http::StatusCode;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::http::request::Parts;
use axum::response::{IntoResponse, Response};
use binnacle_fleet::vessels;
use binnacle_platform::access::{PartyReader, PartyWriter};
use binnacle_platform::app::App;
use binnacle_platform::audit::{Refusal, RequestContext};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{FileContent, Id, Json, Listed, Page, Params, Valid, text};
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::{FeedId, VesselId};
use binnacle_platform::quotas::Quota;
use binnacle_platform::secret;
use binnacle_platform::session;
use binnacle_platform::tenants::Tenant;
use feed::{Feed, Scope};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Quota of a company's calendar feeds.
pub const QUOTA: Quota = Quota::new("calendar_feeds", "calendars", 500, store::count);

/// Prefix of a feed's token.
const PREFIX: &str = "bnc_";

/// Returns the routes of this part.
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

/// Calendar feed to create.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewCalendarFeed, example = json!({ "name": "Our fleet" }))]
struct NewFeed {
    /// Name of the feed.
    #[schema(min_length = 1, max_length = 200)]
    name: String,
    /// Limits an operator's feed to one vessel.
    #[serde(default)]
    vessel_id: Option<VesselId>,
}

/// Calendar feed just created.
#[derive(Serialize, ToSchema)]
#[schema(as = MadeCalendarFeed)]
struct MadeFeed {
    #[serde(flatten)]
    about: Feed,
    /// Secret address to subscribe to, which gives access to the calendar. It is shown once.
    #[schema(example = "https://binnacle.example.com/api/v1/calendar.ics?token=bnc_mZ3q8k…")]
    url: String,
}

/// A page of calendar feeds.
#[derive(Serialize, ToSchema)]
#[schema(as = CalendarFeedList)]
struct FeedList {
    /// Feeds, in order of creation.
    items: Vec<Feed>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// List your calendar feeds
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

/// Create a calendar feed
///
/// The feed has all your work orders, or those of one vessel; an operator's also has port calls and
/// due dates. The response shows its secret address, once. The feed ends when your account is
/// removed, disabled or given a new one-time code.
#[utoipa::path(post, path = "/calendar-feeds", tag = "adjusting", params(Key), request_body = NewFeed,
    responses((status = 201, body = MadeFeed), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "Vessel not found in your fleet", body = Problem),
              (status = 409, description = "Made before", body = Problem),
              (status = 422, body = Problem)))]
async fn create_feed(
    State(app): State<App>,
    request: RequestContext,
    writer: PartyWriter,
    key: Key,
    Valid(new): Valid<NewFeed>,
) -> Result<(StatusCode, Json<MadeFeed>)> {
    let request_hash = idempotency::request_hash("calendar feed", &new)?;
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
    key.shown_once(&mut tx, writer.tenant, &request_hash, about.created_at)
        .await?;
    let hash = secret::hash(&token);
    QUOTA
        .must_have_room(&mut tx, writer.tenant, about.created_at)
        .await?;
    store::insert(&mut tx, writer.tenant, writer.user, &about, &hash).await?;
    tx.commit().await?;
    let base = app.config.mail.public_url.as_deref().unwrap_or_default();
    let base = base.trim_end_matches('/');
    let url = format!("{base}/api/v1/calendar.ics?token={token}");
    Ok((StatusCode::CREATED, Json(MadeFeed { about, url })))
}

/// Delete a calendar feed
///
/// Its address stops working at once.
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

/// Address of a calendar.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Address {
    /// Secret of a calendar feed; without it the caller's own orders are shown.
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
            if found.is_none() {
                RequestContext::of(parts)?.refuse(Refusal::InvalidCode, None);
            }
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
/// iCalendar (RFC 5545), by a feed's secret address or signed in as for any other route. Planned
/// and offered work orders are tentative, accepted ones confirmed. An operator's calendar also has
/// port calls, and each compass's due date as a day, at most a quarter of an hour old. Each event
/// keeps its `UID`, and its `SEQUENCE` grows. Cancelled orders and withdrawn calls stay for some
/// months, marked.
#[utoipa::path(get, path = "/calendar.ics", tag = "adjusting", params(Address),
    responses((status = 200, content_type = "text/calendar", body = inline(FileContent)),
              (status = 401, body = Problem)))]
async fn calendar(State(app): State<App>, scope: Scope) -> Result<Response> {
    let now = app.clock.now().into();
    let found = store::list_orders(&app.db, scope.tenant, scope.vessel, now).await?;
    let (calls, due) = match scope.tenant {
        Tenant::Firm(_) => (Vec::new(), Vec::new()),
        Tenant::Operator(operator) => (
            store::list_calls(&app.db, operator, scope.vessel, now).await?,
            store::list_due_dates(&app.db, operator, scope.vessel).await?,
        ),
    };
    let public_url = app.config.mail.public_url.as_deref();
    let events = ics::render_orders(&found, public_url)?
        .chain(ics::render_calls(&calls, public_url)?)
        .chain(ics::render_due_dates(&due, public_url)?);
    let text = ics::render_calendar(&scope.name, events);
    let headers = [
        (CONTENT_TYPE, "text/calendar; charset=utf-8"),
        (CACHE_CONTROL, "private, max-age=300"),
    ];
    Ok((headers, text).into_response())
}
