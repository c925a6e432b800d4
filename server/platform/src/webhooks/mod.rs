//! Webhooks: messages to the programs of an operator or a firm.
//!
//! Invariants:
//!
//! - Messages are queued and sent by [`crate::outbox`].
//! - Each attempt is signed with the webhook's secret over its time and body.
//! - Nothing is sent to an address outside the public internet, unless the server is
//!   configured to allow it.

mod announce;
mod format;
mod kinds;
mod message;
mod send;
mod store;
mod webhook;

pub use announce::announce;
pub use format::Words;
pub use kinds::{Audience, DeclaredKind, MessageKinds};
pub use message::{TEST, TestMessage};
pub use send::{SIGNATURE_HEADER, Sender};
pub(crate) use store::reseal;

use crate::access::{PartyReader, PartyWriter};
use crate::app::App;
use crate::audit::RequestContext;
use crate::error::{Problem, Result};
use crate::http::{Id, Json, Page, Params, Valid};
use crate::idempotency::{self, Key};
use crate::ids::{DeliveryId, WebhookId};
use crate::outbox::{self, Channel, Delivery, DeliveryList, Filter};
use crate::quotas::Quota;
use crate::secret;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use webhook::{MadeWebhook, NewWebhook, Webhook, WebhookList};

/// Quota of a company's webhooks.
pub const QUOTA: Quota = Quota::new("webhooks", "webhooks", 50, store::count);

/// Prefix of a webhook's secret.
const SECRET_PREFIX: &str = "bns_";

/// Routes of webhooks.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    MessageKinds: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_webhooks, create_webhook))
        .routes(routes!(find_webhook, change_webhook, delete_webhook))
        .routes(routes!(test_webhook))
        .routes(routes!(list_deliveries))
        .routes(routes!(send_delivery_again))
}

/// List the webhooks
#[utoipa::path(get, path = "/webhooks", tag = "alerts", params(Page),
    responses((status = 200, body = WebhookList), (status = 401, body = Problem)))]
async fn list_webhooks(
    State(app): State<App>,
    reader: PartyReader,
    page: Page,
) -> Result<Json<WebhookList>> {
    let found = store::list(&app.db, reader.tenant, page.after_id()?, page.fetch()).await?;
    let listed = page.cut(found, |webhook| webhook.id.to_string());
    Ok(Json(WebhookList {
        items: listed.items,
        next: listed.next,
    }))
}

/// Create a webhook
///
/// The response contains the signing secret, which is never shown again. Messages are signed
/// with it: `Binnacle-Signature: t=SECONDS,v1=HEX`, HMAC-SHA-256 over `SECONDS.BODY`.
#[utoipa::path(post, path = "/webhooks", tag = "alerts", params(Key), request_body = NewWebhook,
    responses((status = 201, body = MadeWebhook), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 409, description = "The quota is used up", body = Problem),
              (status = 422, body = Problem)))]
async fn create_webhook(
    State(app): State<App>,
    State(kinds): State<MessageKinds>,
    request: RequestContext,
    writer: PartyWriter,
    key: Key,
    Valid(new): Valid<NewWebhook>,
) -> Result<(StatusCode, Json<MadeWebhook>)> {
    let request_hash = idempotency::request_hash("webhook", &new)?;
    let kinds = new.find_kinds(&kinds)?;
    let new = new.checked(&kinds, writer.tenant, app.config.webhooks.reach())?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let wanted = WebhookId::new();
    let made = key
        .once(&mut tx, writer.tenant, &request_hash, wanted.0, now)
        .await?;
    if made == wanted.0 {
        QUOTA.must_have_room(&mut tx, writer.tenant, now).await?;
        let secret = format!("{SECRET_PREFIX}{}", secret::new_token());
        store::insert(&mut tx, writer.tenant, wanted, &new, &secret, now).await?;
    }
    let id = WebhookId(made);
    let secret = store::secret(&mut tx, writer.tenant, id).await?;
    tx.commit().await?;
    let about = store::must_find(&app.db, writer.tenant, id).await?;
    Ok((StatusCode::CREATED, Json(MadeWebhook { about, secret })))
}

/// Show a webhook
#[utoipa::path(get, path = "/webhooks/{id}", tag = "alerts", params(("id" = WebhookId, Path)),
    responses((status = 200, body = Webhook), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_webhook(
    State(app): State<App>,
    reader: PartyReader,
    Id(id): Id<WebhookId>,
) -> Result<Json<Webhook>> {
    Ok(Json(store::must_find(&app.db, reader.tenant, id).await?))
}

/// Change a webhook
///
/// Its secret stays. While it is disabled nothing is queued, and pending messages wait.
#[utoipa::path(put, path = "/webhooks/{id}", tag = "alerts", params(("id" = WebhookId, Path)),
    request_body = NewWebhook,
    responses((status = 200, body = Webhook), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn change_webhook(
    State(app): State<App>,
    State(kinds): State<MessageKinds>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<WebhookId>,
    Valid(wanted): Valid<NewWebhook>,
) -> Result<Json<Webhook>> {
    let kinds = wanted.find_kinds(&kinds)?;
    store::must_find(&app.db, writer.tenant, id).await?;
    let wanted = wanted.checked(&kinds, writer.tenant, app.config.webhooks.reach())?;
    let mut tx = request.begin().await?;
    store::change(&mut tx, writer.tenant, id, &wanted).await?;
    tx.commit().await?;
    Ok(Json(store::must_find(&app.db, writer.tenant, id).await?))
}

/// Remove a webhook
///
/// Pending messages to it are deleted.
#[utoipa::path(delete, path = "/webhooks/{id}", tag = "alerts", params(("id" = WebhookId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem)))]
async fn delete_webhook(
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<WebhookId>,
) -> Result<StatusCode> {
    let mut tx = request.begin().await?;
    outbox::delete(&mut tx, writer.tenant, id.0, Channel::Webhook).await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Send a test message to a webhook
///
/// It is queued like any other message.
#[utoipa::path(post, path = "/webhooks/{id}/test", tag = "alerts",
    params(("id" = WebhookId, Path)),
    responses((status = 202, body = Delivery), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem)))]
async fn test_webhook(
    State(app): State<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<WebhookId>,
) -> Result<(StatusCode, Json<Delivery>)> {
    store::must_find(&app.db, writer.tenant, id).await?;
    let now = app.clock.now().into();
    let message = TestMessage::new(now).queued()?;
    let queued = outbox::queue_one(&request, id.0, &message, now).await?;
    Ok((StatusCode::ACCEPTED, Json(queued)))
}

/// List a webhook's deliveries
///
/// With `state=dead`, the dead letters. Finished deliveries are kept for 30 days.
#[utoipa::path(get, path = "/webhooks/{id}/deliveries", tag = "alerts",
    params(("id" = WebhookId, Path), Filter, Page),
    responses((status = 200, body = DeliveryList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_deliveries(
    State(app): State<App>,
    reader: PartyReader,
    Id(id): Id<WebhookId>,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<DeliveryList>> {
    store::must_find(&app.db, reader.tenant, id).await?;
    Ok(Json(outbox::list(&app.db, id.0, filter, &page).await?))
}

/// Send a delivery again
///
/// It is sent at once, with the same id and body, and retried for another day if necessary.
#[utoipa::path(post, path = "/webhooks/{id}/deliveries/{delivery}/resend", tag = "alerts",
    params(("id" = WebhookId, Path), ("delivery" = DeliveryId, Path)),
    responses((status = 202, body = Delivery), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem)))]
async fn send_delivery_again(
    State(app): State<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id((id, delivery)): Id<(WebhookId, DeliveryId)>,
) -> Result<(StatusCode, Json<Delivery>)> {
    store::must_find(&app.db, writer.tenant, id).await?;
    let now = app.clock.now().into();
    let queued = outbox::send_again(&request, id.0, delivery, now).await?;
    Ok((StatusCode::ACCEPTED, Json(queued)))
}
