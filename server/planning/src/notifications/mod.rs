//! Notifications for each person: list, mail and digest.
//!
//! Invariants:
//!
//! - A notification is stored in the transaction of its event. The author of the event gets none.
//! - Mail waits for the end of a person's quiet hours, or for their digest. Urgent mail waits for
//!   neither. Letters go through [`binnacle_platform::outbox`].
//! - A person sees their own notifications only.

mod channel;
mod create;
mod digest;
mod kinds;
mod needs;
mod notification;
mod send;
mod settings;
mod store;

pub use create::create_notifications;
pub use kinds::NoticeKinds;
pub use needs::{NOTICE_KINDS, notify_of_needs};
pub use send::{MESSAGE_KIND, send_due, watch};

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
use channel::Channel;
use indexmap::IndexMap;
use notification::{Filter, Notification};
use serde::{Deserialize, Serialize};
use settings::Settings;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes of this part.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    NoticeKinds: FromRef<S>,
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
struct NotificationsRead {
    /// The last notification to mark; all by default.
    until: Option<NotificationId>,
}

/// Change to a notification.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = ChangedNotification)]
struct ChangedNotification {
    /// `true` when you have read it.
    read: bool,
}

/// Notification settings in force.
#[derive(Serialize, ToSchema)]
#[schema(as = NotificationSettingsInForce)]
struct SettingsInForce {
    /// Your settings.
    settings: Settings,
    /// Every kind that concerns you, with its way of delivery.
    #[schema(value_type = BTreeMap<Kind, Channel>)]
    ways: IndexMap<&'static str, Channel>,
    /// Address for mail, with which you sign in.
    #[schema(example = "ada@example.com")]
    address: String,
    /// `true` when this server is set up to send mail.
    sending: bool,
    /// Time of the next digest; an empty one is not sent.
    next_digest_at: Time,
}

/// List your notifications
///
/// Notifications are kept for 90 days.
#[utoipa::path(get, path = "/notifications", tag = "notifications", params(Filter, Page),
    responses((status = 200, body = NotificationList), (status = 401, body = Problem)))]
async fn list_notifications(
    State(app): State<App>,
    State(kinds): State<NoticeKinds>,
    caller: Caller,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<NotificationList>> {
    let user = require_recipient(&caller)?.user.user_id;
    filter.check(&kinds)?;
    let before = page.after_id()?;
    let found = store::list(&app.db, user, &filter, before, page.fetch()).await?;
    let listed = page.cut(found, |notification| notification.id.to_string());
    Ok(Json(NotificationList {
        items: listed.items,
        next: listed.next,
        unread: store::count_unread(&app.db, user).await?,
    }))
}

/// Mark notifications as read
///
/// Notifications that have been read are not mailed any more.
#[utoipa::path(post, path = "/notifications/read", tag = "notifications",
    request_body = Option<NotificationsRead>,
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem)))]
async fn mark_notifications_read(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    ValidOrNone(read): ValidOrNone<NotificationsRead>,
) -> Result<StatusCode> {
    caller.must_not_only_read()?;
    let user = require_recipient(&caller)?.user.user_id;
    let mut tx = request.begin().await?;
    store::mark_read(&mut tx, user, read.until, app.clock.now().into()).await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Mark a notification as read or unread
#[utoipa::path(patch, path = "/notifications/{id}", tag = "notifications",
    params(("id" = NotificationId, Path)), request_body = ChangedNotification,
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem)))]
async fn change_notification(
    State(app): State<App>,
    request: RequestContext,
    caller: Caller,
    Id(id): Id<NotificationId>,
    Valid(changed): Valid<ChangedNotification>,
) -> Result<StatusCode> {
    caller.must_not_only_read()?;
    let user = require_recipient(&caller)?.user.user_id;
    let read_at = changed.read.then(|| app.clock.now().into());
    let mut tx = request.begin().await?;
    if !store::mark(&mut tx, user, id, read_at).await? {
        return Err(Error::NotFound("notification"));
    }
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// See your notification settings
#[utoipa::path(get, path = "/me/notifications", tag = "notifications",
    responses((status = 200, body = SettingsInForce), (status = 401, body = Problem)))]
async fn find_notification_settings(
    State(app): State<App>,
    State(kinds): State<NoticeKinds>,
    caller: Caller,
) -> Result<Json<SettingsInForce>> {
    let settings = store::find_settings(&app.db, require_recipient(&caller)?.user.user_id).await?;
    Ok(Json(SettingsInForce::new(&app, &kinds, &caller, settings)))
}

/// Change your notification settings
///
/// Notifications that wait for mail follow the new settings.
#[utoipa::path(put, path = "/me/notifications", tag = "notifications", request_body = Settings,
    responses((status = 200, body = SettingsInForce), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem)))]
async fn change_notification_settings(
    State(app): State<App>,
    State(kinds): State<NoticeKinds>,
    request: RequestContext,
    caller: Caller,
    Valid(settings): Valid<Settings>,
) -> Result<Json<SettingsInForce>> {
    caller.must_not_only_read()?;
    let (user, role) = (require_recipient(&caller)?.user.user_id, caller.user.role);
    let settings = settings.checked(role, &kinds)?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    store::put_settings(&mut tx, user, &settings, now).await?;
    for (id, name, urgent) in store::list_waiting_for_mail(&mut tx, user).await? {
        let kind = kinds.find(&name).map_err(anyhow::Error::msg)?;
        let mail_at = settings.mail_at(settings.way(kind, role), urgent, now);
        store::reschedule_mail(&mut tx, user, id, mail_at).await?;
    }
    tx.commit().await?;
    Ok(Json(SettingsInForce::new(&app, &kinds, &caller, settings)))
}

/// Returns the caller if they get notifications at all.
///
/// # Errors
/// Fails for a platform admin, who has neither a fleet nor orders.
fn require_recipient(caller: &Caller) -> Result<&Caller> {
    caller.party()?;
    Ok(caller)
}

impl SettingsInForce {
    fn new(app: &App, kinds: &NoticeKinds, caller: &Caller, settings: Settings) -> SettingsInForce {
        let role: Role = caller.user.role;
        let own = kinds.all().filter(|kind| kind.readers.include(role));
        let ways = own.map(|kind| (kind.name(), settings.way(kind, role)));
        SettingsInForce {
            ways: ways.collect(),
            address: caller.user.email.clone(),
            sending: app.config.mail.is_set_up(),
            next_digest_at: settings.next_digest(app.clock.now().into()),
            settings,
        }
    }
}
