//! Messages between an operator and a firm about an order.
//!
//! Invariants: a message is an entry of the order's log; no other firm reads it.

use crate::dispatch::offer_requests::{checked_message, require_own_firm};
use crate::work_orders::events::{MessageSent, OrderEvent};
use crate::work_orders::offers::{Offer, OfferState, Offers};
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::{prepare_update, store};
use axum::extract::{FromRef, State as Shared};
use axum::http::StatusCode;
use binnacle_platform::access::{PartyReader, PartyWriter};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Tx, row};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Valid};
use binnacle_platform::idempotency::Key;
use binnacle_platform::ids::{FirmId, OrderId};
use binnacle_platform::quotas::Quota;
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use futures_util::future::BoxFuture;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Quota of the entries in the log of one order, beyond which no message is added.
pub const QUOTA: Quota = Quota::new(
    "order_log",
    "entries in the log of the order",
    2000,
    longest_log,
);

pub(crate) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(list_messages, send_message))
}

/// Message to send.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewOrderMessage, example = json!({ "text": "Is the gangway to port?" }))]
struct NewMessage {
    /// Firm that the operator writes to; optional if there is one only.
    #[serde(default)]
    firm_id: Option<FirmId>,
    /// Text, 2,000 characters at most.
    #[schema(min_length = 1, max_length = 2000)]
    text: String,
}

/// Message about an order.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = OrderMessage)]
struct Message {
    /// Number in the order's log.
    seq: i64,
    /// Time of sending.
    at: Time,
    /// Name of the sender.
    by: String,
    /// True if the firm sent it, false if the operator did.
    from_firm: bool,
    /// The firm.
    firm_id: FirmId,
    /// Its name.
    firm_name: String,
    /// Text.
    text: String,
}

/// Page of messages.
#[derive(Serialize, ToSchema)]
#[schema(as = OrderMessageList)]
struct MessageList {
    /// Messages, the oldest first.
    items: Vec<Message>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// List the messages about a work order
///
/// A firm reads its own only. Changes of the port call are among them, from `Binnacle`.
#[utoipa::path(get, path = "/work-orders/{id}/messages", tag = "adjusting",
    params(("id" = OrderId, Path), Page),
    responses((status = 200, body = MessageList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_messages(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
    page: Page,
) -> Result<Json<MessageList>> {
    let after = page.after_number()?.unwrap_or(0);
    let stored = store::find(&app.db, reader.tenant, id).await?;
    let sees = |firm: FirmId| reader.tenant.firm().is_none_or(|own| own == firm);
    let sent = stored.log.into_iter().filter_map(|entry| {
        let exchange = match entry.content {
            OrderEvent::Message(message) => message.0,
            OrderEvent::CallMoved(moved) => moved.exchange,
            _ => return None,
        };
        (entry.seq > after && sees(exchange.firm.firm_id)).then(|| Message {
            seq: entry.seq,
            at: entry.at,
            by: entry.author.name,
            from_firm: entry.author.firm_id.is_some(),
            firm_id: exchange.firm.firm_id,
            firm_name: exchange.firm.firm_name,
            text: exchange.text.unwrap_or_default(),
        })
    });
    let listed = page.cut(sent.collect(), |message: &Message| message.seq.to_string());
    Ok(Json(MessageList {
        items: listed.items,
        next: listed.next,
    }))
}

/// Send a message about a work order
///
/// To the operator, or to a firm that has been offered the order or has it.
#[utoipa::path(post, path = "/work-orders/{id}/messages", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = NewMessage,
    responses((status = 204), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "No such firm has an open offer or the order", body = Problem),
              (status = 422, body = Problem)))]
async fn send_message(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(new): Valid<NewMessage>,
) -> Result<StatusCode> {
    let update = prepare_update(&app, request, writer, id, key, "message", &new)?;
    require_own_firm(writer.tenant, new.firm_id)?;
    let text = checked_message(&new.text)?;
    let summary = store::find_summary(&app.db, writer.tenant, id).await?;
    if summary.state.is_over() {
        return Err(Error::WrongState(
            "the order is closed or cancelled".to_owned(),
        ));
    }
    if let Some(mut change) = update.begin_on(summary.vessel_id).await? {
        let entries = change.stored.log.len() as i64;
        QUOTA
            .must_be_above(&mut change.tx, writer.tenant, entries)
            .await?;
        let offers = change.stored.state().offers;
        let exchange = Exchange {
            text: Some(text),
            ..Exchange::with(addressee(&offers, writer.tenant, new.firm_id)?.firm())
        };
        change
            .append(OrderEvent::Message(MessageSent(exchange)))
            .await?;
        change.commit().await?;
    }
    Ok(StatusCode::NO_CONTENT)
}

/// Counts the entries of a tenant's longest log of an order.
fn longest_log(
    tx: &mut Tx,
    tenant: Tenant,
    _: Time,
) -> BoxFuture<'_, binnacle_platform::db::Result<i64>> {
    Box::pin(async move {
        let found = row!(
            in tx,
            (i64,),
            "SELECT COALESCE(MAX(e.seq), 0) FROM work_order_entries e
             JOIN vessels v ON v.id = e.vessel_id
             WHERE v.operator_id = $1",
            tenant.operator()
        )?;
        Ok(found.map_or(0, |(entries,)| entries))
    })
}

/// Firm that a message is from or to.
fn addressee(offers: &Offers, tenant: Tenant, named: Option<FirmId>) -> Result<&Offer> {
    let firm = tenant.firm().or(named);
    let seen =
        |offer: &&Offer| offer.state.is_seen() && firm.is_none_or(|firm| firm == offer.firm_id);
    let mut found: Vec<&Offer> = offers.all.iter().filter(seen).collect();
    if firm.is_none() {
        // One of several firms with an offer may have accepted already.
        let holder = found
            .iter()
            .position(|offer| offer.state == OfferState::Accepted);
        if let Some(holder) = holder {
            found = vec![found[holder]];
        }
    }
    match found.as_slice() {
        [firm] => Ok(firm),
        [] => Err(Error::WrongState(
            "no such firm has an open offer or the order".to_owned(),
        )),
        _ => Err(Error::Invalid {
            field: "firm_id",
            detail: "is required: more than one firm has an open offer".to_owned(),
        }),
    }
}
