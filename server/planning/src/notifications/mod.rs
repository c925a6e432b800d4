//! Notifications: telling each person of what concerns them, as they want to be told.
//!
//! What always holds:
//!
//! - What a person ought to know is written for that person in the transaction that makes
//!   it true; who made it so is not told.
//! - Mail waits for the end of a person's quiet hours, or for their digest; what is urgent
//!   waits for neither. Letters go through [`binnacle_platform::outbox`].
//! - A notification is its person's own: nobody else finds it.

mod create;
mod digest;
mod needs;
mod notification;
mod send;
mod settings;
mod store;
mod way;

pub use create::create;
pub use needs::look;
pub use send::{post, watch};

use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::Caller;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Params, Valid, ValidOrNone};
use binnacle_platform::ids::NotificationId;
use binnacle_platform::notices::Kind;
use binnacle_platform::session::Role;
use binnacle_platform::time::Time;
use notification::{Filter, Notification};
use serde::{Deserialize, Serialize};
use settings::Settings;
use std::collections::BTreeMap;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use way::Way;

/// The routes of this part.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_notifications))
        .routes(routes!(mark_notifications_read))
        .routes(routes!(change_notification))
        .routes(routes!(
            find_notification_settings,
            change_notification_settings
        ))
}

/// A page of notifications.
#[derive(Serialize, ToSchema)]
struct NotificationList {
    /// The newest first.
    items: Vec<Notification>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
    /// Number of unread notifications on all pages.
    unread: i64,
}

/// Notifications to mark as read.
#[derive(Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NotificationsRead)]
struct Read {
    /// This one and all before it; all there are if not said.
    until: Option<NotificationId>,
}

/// Change to a notification.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = ChangedNotification)]
struct Changed {
    /// Whether you have read it.
    read: bool,
}

/// Notification settings in force.
#[derive(Serialize, ToSchema)]
#[schema(as = NotificationSettingsInForce)]
struct InForce {
    /// Your settings.
    settings: Settings,
    /// Every kind that you are told of, with the way in force.
    ways: BTreeMap<Kind, Way>,
    /// Address for mail: the one you sign in with.
    #[schema(example = "ada@example.com")]
    address: String,
    /// Whether this server is set up to send mail.
    sending: bool,
    /// Time of the next digest, if there is anything in it.
    next_digest_at: Time,
}

/// List what you ought to know
///
/// Notifications are kept for 90 days.
#[utoipa::path(get, path = "/notifications", tag = "notifications", params(Filter, Page),
    responses((status = 200, body = NotificationList), (status = 401, body = Problem)))]
async fn list_notifications(
    State(app): State<App>,
    caller: Caller,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<NotificationList>> {
    let user = told(&caller)?.user.user_id;
    let before = page.after_id()?;
    let found = store::list(&app.db, user, &filter, before, page.fetch()).await?;
    let listed = page.cut(found, |notification| notification.id.to_string());
    Ok(Json(NotificationList {
        items: listed.items,
        next: listed.next,
        unread: store::unread(&app.db, user).await?,
    }))
}

/// Mark notifications as read
///
/// What is read is not told by mail any more.
#[utoipa::path(post, path = "/notifications/read", tag = "notifications",
    request_body = Option<Read>,
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem)))]
async fn mark_notifications_read(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    ValidOrNone(read): ValidOrNone<Read>,
) -> Result<StatusCode> {
    caller.must_not_only_read()?;
    let user = told(&caller)?.user.user_id;
    let mut tx = request.begin().await?;
    store::mark_read(&mut tx, user, read.until, app.clock.now().into()).await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Mark a notification as read or unread
#[utoipa::path(patch, path = "/notifications/{id}", tag = "notifications",
    params(("id" = NotificationId, Path)), request_body = Changed,
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem)))]
async fn change_notification(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    Id(id): Id<NotificationId>,
    Valid(changed): Valid<Changed>,
) -> Result<StatusCode> {
    caller.must_not_only_read()?;
    let user = told(&caller)?.user.user_id;
    let read_at = changed.read.then(|| app.clock.now().into());
    let mut tx = request.begin().await?;
    if !store::mark(&mut tx, user, id, read_at).await? {
        return Err(Error::NotFound("notification"));
    }
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// See how you are told
#[utoipa::path(get, path = "/me/notifications", tag = "notifications",
    responses((status = 200, body = InForce), (status = 401, body = Problem)))]
async fn find_notification_settings(
    State(app): State<App>,
    caller: Caller,
) -> Result<Json<InForce>> {
    let settings = store::settings(&app.db, told(&caller)?.user.user_id).await?;
    Ok(Json(InForce::new(&app, &caller, settings)))
}

/// Say how you want to be told
///
/// What waits to be mailed follows the new settings.
#[utoipa::path(put, path = "/me/notifications", tag = "notifications", request_body = Settings,
    responses((status = 200, body = InForce), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem)))]
async fn change_notification_settings(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    Valid(settings): Valid<Settings>,
) -> Result<Json<InForce>> {
    caller.must_not_only_read()?;
    let (user, role) = (told(&caller)?.user.user_id, caller.user.role);
    let settings = settings.checked(role)?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    store::put_settings(&mut tx, user, &settings, now).await?;
    for (id, kind, urgent) in store::waiting(&mut tx, user).await? {
        let mail_at = settings.mail_at(settings.way(kind, role), urgent, now);
        store::put_off(&mut tx, user, id, mail_at).await?;
    }
    tx.commit().await?;
    Ok(Json(InForce::new(&app, &caller, settings)))
}

/// Refuses who is told of nothing: a platform admin has neither a fleet nor orders.
fn told(caller: &Caller) -> Result<&Caller> {
    caller.party()?;
    Ok(caller)
}

impl InForce {
    fn new(app: &App, caller: &Caller, settings: Settings) -> InForce {
        let role: Role = caller.user.role;
        let told = Kind::ALL.into_iter().filter(|kind| kind.concerns(role));
        InForce {
            ways: told.map(|kind| (kind, settings.way(kind, role))).collect(),
            address: caller.user.email.clone(),
            sending: app.config.mail.is_set_up(),
            next_digest_at: settings.next_digest(app.clock.now().into()),
            settings,
        }
    }
}
