//! Mail: letters to the recipients of an operator, about topics that have a severity.
//!
//! Invariants:
//!
//! - Letters are queued and sent by [`crate::outbox`]. A letter that the relay accepted is not
//!   sent again. A letter whose response was lost is sent again with the same message id.
//! - A recipient gets a letter when a topic reaches the recipient's severity and when it gets
//!   worse than in the last letter. A last letter follows when the topic ends or sinks below
//!   that severity. New details alone cause no letter.
//! - Text of users cannot form a header: names are encoded, and line breaks are removed.

mod admins;
mod announce;
mod letter;
mod mailing_list;
mod recipient;
mod relay;
mod send;
mod sender;
mod store;

pub use announce::{Announcement, Phase, announce};
pub use letter::{Letter, LetterItem, header, one_line, wrapped};
pub use mailing_list::{
    Content, File, FileReference, Files, FindAddress, LoadFiles, MailingList, TopicList,
};
pub use recipient::address;
pub use relay::Relay;
pub use send::Mailer;
pub use sender::Sender;

use crate::access::{Reader, Writer};
use crate::app::App;
use crate::audit::RequestContext;
use crate::error::{Error, Problem, Result};
use crate::http::{Id, Json, Page, Params, Valid};
use crate::idempotency::{self, Key};
use crate::ids::{DeliveryId, RecipientId};
use crate::outbox::{self, Channel, Delivery, DeliveryList, Filter, Kind, Message};
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use recipient::{ChangedRecipient, NewRecipient, Recipient, RecipientList};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Routes of mail recipients.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    TopicList: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_recipients, create_recipient))
        .routes(routes!(find_recipient, change_recipient, delete_recipient))
        .routes(routes!(test_recipient))
        .routes(routes!(list_letters))
        .routes(routes!(send_letter_again))
}

/// List the mail recipients
#[utoipa::path(get, path = "/mail-recipients", tag = "alerts", params(Page),
    responses((status = 200, body = RecipientList), (status = 401, body = Problem)))]
async fn list_recipients(
    State(app): State<App>,
    reader: Reader,
    page: Page,
) -> Result<Json<RecipientList>> {
    let found = store::list(&app.db, reader.operator, page.after_id()?, page.fetch()).await?;
    let listed = page.cut(found, |recipient| recipient.id.to_string());
    Ok(Json(RecipientList {
        items: listed.items,
        next: listed.next,
        sending: app.config.mail.is_set_up(),
    }))
}

/// Add a mail recipient
///
/// The recipient gets mail from the next alert that has or reaches `severity`.
#[utoipa::path(post, path = "/mail-recipients", tag = "alerts", params(Key),
    request_body = NewRecipient,
    responses((status = 201, body = Recipient), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 409, description = "Mail is not set up on this server", body = Problem),
              (status = 422, body = Problem)))]
async fn create_recipient(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    key: Key,
    Valid(new): Valid<NewRecipient>,
) -> Result<(StatusCode, Json<Recipient>)> {
    must_be_set_up(&app)?;
    let request_hash = idempotency::request_hash("mail recipient", &new)?;
    let new = new.checked()?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let wanted = RecipientId::new();
    let made = key
        .once(&mut tx, writer.operator, &request_hash, wanted.0, now)
        .await?;
    if made == wanted.0 {
        store::insert(&mut tx, writer.operator, wanted, &new, now).await?;
    }
    tx.commit().await?;
    let recipient = store::must_find(&app.db, writer.operator, RecipientId(made)).await?;
    Ok((StatusCode::CREATED, Json(recipient)))
}

/// Show a mail recipient
#[utoipa::path(get, path = "/mail-recipients/{id}", tag = "alerts",
    params(("id" = RecipientId, Path)),
    responses((status = 200, body = Recipient), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_recipient(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<RecipientId>,
) -> Result<Json<Recipient>> {
    Ok(Json(store::must_find(&app.db, reader.operator, id).await?))
}

/// Change a mail recipient's minimum severity
#[utoipa::path(put, path = "/mail-recipients/{id}", tag = "alerts",
    params(("id" = RecipientId, Path)), request_body = ChangedRecipient,
    responses((status = 200, body = Recipient), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn change_recipient(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<RecipientId>,
    Valid(wanted): Valid<ChangedRecipient>,
) -> Result<Json<Recipient>> {
    let mut tx = request.begin().await?;
    store::change(&mut tx, writer.operator, id, wanted.severity).await?;
    tx.commit().await?;
    Ok(Json(store::must_find(&app.db, writer.operator, id).await?))
}

/// Remove a mail recipient
///
/// Pending letters are deleted.
#[utoipa::path(delete, path = "/mail-recipients/{id}", tag = "alerts",
    params(("id" = RecipientId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem)))]
async fn delete_recipient(
    request: RequestContext,
    writer: Writer,
    Id(id): Id<RecipientId>,
) -> Result<StatusCode> {
    let mut tx = request.begin().await?;
    outbox::delete(&mut tx, writer.operator, id.0, Channel::Mail).await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Send a test letter
///
/// It is queued like any other letter.
#[utoipa::path(post, path = "/mail-recipients/{id}/test", tag = "alerts",
    params(("id" = RecipientId, Path)),
    responses((status = 202, body = Delivery), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Mail is not set up on this server", body = Problem)))]
async fn test_recipient(
    State(app): State<App>,
    State(list): State<TopicList>,
    request: RequestContext,
    writer: Writer,
    Id(id): Id<RecipientId>,
) -> Result<(StatusCode, Json<Delivery>)> {
    store::must_find(&app.db, writer.operator, id).await?;
    must_be_set_up(&app)?;
    let message = Message {
        id: DeliveryId::new(),
        kind: Kind::TEST,
        about: None,
        body: serde_json::to_string(&Letter::test(list))?,
    };
    let queued = outbox::queue_one(&request, id.0, &message, app.clock.now().into()).await?;
    Ok((StatusCode::ACCEPTED, Json(queued)))
}

/// List a recipient's letters
///
/// With `state=dead`, the letters that were given up. Finished deliveries are kept for 30 days.
#[utoipa::path(get, path = "/mail-recipients/{id}/deliveries", tag = "alerts",
    params(("id" = RecipientId, Path), Filter, Page),
    responses((status = 200, body = DeliveryList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_letters(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<RecipientId>,
    Params(filter): Params<Filter>,
    page: Page,
) -> Result<Json<DeliveryList>> {
    store::must_find(&app.db, reader.operator, id).await?;
    Ok(Json(outbox::list(&app.db, id.0, filter, &page).await?))
}

/// Send a letter again
///
/// The letter is sent at once, with the same message id. It is retried for another day if
/// necessary.
#[utoipa::path(post, path = "/mail-recipients/{id}/deliveries/{delivery}/resend", tag = "alerts",
    params(("id" = RecipientId, Path), ("delivery" = DeliveryId, Path)),
    responses((status = 202, body = Delivery), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem)))]
async fn send_letter_again(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id((id, delivery)): Id<(RecipientId, DeliveryId)>,
) -> Result<(StatusCode, Json<Delivery>)> {
    store::must_find(&app.db, writer.operator, id).await?;
    let now = app.clock.now().into();
    let queued = outbox::send_again(&request, id.0, delivery, now).await?;
    Ok((StatusCode::ACCEPTED, Json(queued)))
}

/// # Errors
/// [`Error::NotSetUp`] when this server sends no mail.
pub fn must_be_set_up(app: &App) -> Result<()> {
    if app.config.mail.is_set_up() {
        return Ok(());
    }
    Err(Error::NotSetUp(
        "mail is not set up on this server (--smtp-url)",
    ))
}
