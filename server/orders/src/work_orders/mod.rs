//! Work orders: the adjustment of one compass of one vessel at the berth, without a swing.
//!
//! Invariants:
//!
//! - An order is its log: entries that are never changed or removed, each with the hash of
//!   the one before. The state follows from them, in the same transaction.
//! - A repeated request under its key writes nothing more, and is answered by the present
//!   order: the page at the binnacle retries after a bad connection.
//! - A prediction is called one until headings at sea agree. Nothing here issues a
//!   certificate.

pub(crate) mod events;
pub(crate) mod log;
pub mod message_kinds;
pub(crate) mod new_order;
pub mod notice_kinds;
mod notification_text;
pub(crate) mod offers;
pub(crate) mod order;
pub(crate) mod order_state;
pub(crate) mod order_update;
pub(crate) mod payload;
pub(crate) mod publish;
pub(crate) mod refusal;
pub(crate) mod state;
pub(crate) mod store;
mod subscriber;
pub(crate) mod summary;
pub(crate) mod webhook_message;

pub use log::canonical_json::sha256_hex;
pub use new_order::{NewOffer, NewOrder};
pub use payload::hours::Hours;
pub use payload::port_call::{Alongside, CallFit};
pub use refusal::{Cure, NotAdjustableFields, Refusal};
pub use state::State;
pub use store::lock_compass;
pub use subscriber::{refuse_amended_binnacle, refuse_leave_of_service};
pub use webhook_message::WorkOrderMessage;

use binnacle_platform::access::PartyWriter;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::Result;
use binnacle_platform::http::Json;
use binnacle_platform::idempotency::{self, Key};
use binnacle_platform::ids::OrderId;
use binnacle_platform::tenants::Tenant;
use order::Order;
use order_update::OrderUpdate;
use serde::Serialize;

/// Prepares a change of an order; `what` distinguishes it from other requests.
pub(crate) fn prepare_update<'a>(
    app: &'a App,
    request: RequestContext,
    writer: impl Into<PartyWriter>,
    order: OrderId,
    key: Key,
    what: &str,
    content: &impl Serialize,
) -> Result<OrderUpdate<'a>> {
    Ok(OrderUpdate {
        app,
        request,
        writer: writer.into(),
        order,
        key,
        hash: idempotency::request_hash(&format!("{what} of {order}"), content)?,
    })
}

/// Returns the order as it is.
pub(crate) async fn load_order(
    app: &App,
    tenant: impl Into<Tenant>,
    id: OrderId,
) -> Result<Json<Order>> {
    let tenant = tenant.into();
    let stored = store::find(&app.db, tenant, id).await?;
    let state = stored.state();
    Ok(Json(Order::new(stored.summary, state, tenant)))
}
