//! Messages of work orders for webhooks.
//!
//! Invariants: a message has the order in short as its receiver sees it, and one entry of its
//! log. What is confidential between the operator and one firm is in that firm's messages only.

use crate::work_orders::log::entry::Entry;
use crate::work_orders::payload::exchange::Terms;
use crate::work_orders::payload::port_call::{CallChange, CallFit};
use crate::work_orders::state::State;
use crate::work_orders::summary::Summary;
use binnacle_platform::ids::{DeliveryId, FirmId, OrderId, VesselId};
use binnacle_platform::outbox::{Kind, Message};
use binnacle_platform::time::Time;
use binnacle_platform::webhooks::Words;
use serde::Serialize;
use serde_json::json;
use utoipa::ToSchema;

/// Message of a work order for webhooks.
#[derive(Serialize, ToSchema)]
pub struct WorkOrderMessage<'a> {
    /// Id of the message: the same in each attempt.
    id: DeliveryId,
    /// Kind.
    kind: Kind,
    /// Time of the event.
    at: Time,
    /// The message in words.
    words: Words,
    /// The order at that moment, in short.
    work_order: MessageOrder<'a>,
    /// Entry of the order's log.
    entry: MessageEntry<'a>,
}

/// Work order in short.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrderMessageOrder)]
struct MessageOrder<'a> {
    /// The order's id.
    id: OrderId,
    /// State.
    state: State,
    /// Deadline for an answer.
    #[schema(required)]
    answer_by: Option<Time>,
    /// Operator's name.
    operator_name: &'a str,
    /// The vessel.
    vessel_id: VesselId,
    /// The vessel's name.
    vessel_name: &'a str,
    /// The compass's name.
    compass_name: &'a str,
    /// Port.
    port: &'a str,
    /// Berth.
    #[schema(required)]
    berth: Option<&'a str>,
    /// Time of the job.
    planned_at: Time,
    /// End of the job.
    planned_until: Time,
    /// Time of the job in the port's legal time; `null` if the port is unknown.
    #[schema(required)]
    planned_at_local: Option<&'a str>,
    /// End of the job in the port's legal time.
    #[schema(required)]
    planned_until_local: Option<&'a str>,
    /// Fit of its time to the port call, if that has moved since the time was agreed.
    #[schema(required)]
    call_fit: Option<CallFit>,
}

/// Entry of a work order's log in short. One that is about no exchange with a firm has neither
/// firm nor terms; a withdrawal has only its number, kind and time.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrderMessageEntry)]
pub(crate) struct MessageEntry<'a> {
    /// Number in the log.
    seq: i64,
    /// Kind of the entry, as in the order's log.
    #[schema(value_type = String, example = "accepted")]
    kind: serde_json::Value,
    /// Time.
    at: Time,
    /// Author's name.
    #[schema(required)]
    by: Option<&'a str>,
    /// Firm of the exchange.
    #[schema(required)]
    firm_id: Option<FirmId>,
    /// Fee offered, or accepted as offered, euros.
    #[schema(required)]
    fee_eur: Option<f64>,
    /// Team of the firm that is to come, if its teams have names.
    #[schema(required)]
    team: Option<&'a str>,
    /// Proposed or agreed terms.
    #[schema(required)]
    terms: Option<&'a Terms>,
    /// Text.
    #[schema(required)]
    text: Option<&'a str>,
    /// Change of the port call.
    #[schema(required)]
    call: Option<&'a CallChange>,
}

impl<'a> MessageEntry<'a> {
    /// An entry for the webhooks of those who may read it.
    pub(crate) fn of(entry: &'a Entry) -> MessageEntry<'a> {
        let event = entry.content.event();
        let exchange = event.exchange();
        let content = serde_json::to_value(&entry.content).unwrap_or_default();
        MessageEntry {
            seq: entry.seq,
            kind: content["kind"].clone(),
            at: entry.at,
            by: Some(&entry.author.name),
            firm_id: exchange.map(|exchange| exchange.firm.firm_id),
            fee_eur: exchange.and_then(|exchange| exchange.fee_eur),
            team: exchange.and_then(|exchange| exchange.team.as_deref()),
            terms: exchange.and_then(|exchange| exchange.terms.as_ref()),
            text: exchange.and_then(|exchange| exchange.text.as_deref()),
            call: event.call_change(),
        }
    }

    /// A withdrawal for the firm that it concerns. The reason is not its business.
    pub(crate) fn withdrawal(last: &Entry) -> MessageEntry<'static> {
        MessageEntry {
            seq: last.seq,
            kind: json!("withdrawn"),
            at: last.at,
            by: None,
            firm_id: None,
            fee_eur: None,
            team: None,
            terms: None,
            text: None,
            call: None,
        }
    }

    /// The entry with its order, as the receiver sees it.
    pub(crate) fn about(self, order: &'a Summary) -> OrderAndEntry<'a> {
        OrderAndEntry { order, entry: self }
    }
}

/// Returns an order and its entry in words.
fn words(order: &Summary, entry: &MessageEntry<'_>) -> Words {
    let event = entry.kind.as_str().unwrap_or_default().replace('_', " ");
    let planned = order.planned_at_local.as_deref();
    let planned = planned.map_or(order.planned_at.to_the_minute(), str::to_owned);
    let place = [Some(order.port.as_str()), order.berth.as_deref()];
    let said = [entry.by, entry.text].into_iter().flatten();
    let parts = [order.compass_name.as_str()].into_iter();
    let parts = parts.chain(place.into_iter().flatten());
    let parts: Vec<&str> = parts.chain([planned.as_str()]).chain(said).collect();
    Words {
        headline: format!("{}: work order, {event}", order.vessel_name),
        text: parts.join(" · "),
        path: format!("/work-orders/{}", order.id),
    }
}

/// An order and one of its entries.
pub(crate) struct OrderAndEntry<'a> {
    order: &'a Summary,
    entry: MessageEntry<'a>,
}

impl OrderAndEntry<'_> {
    /// Returns the message as it is queued.
    pub(crate) fn queued(self, kind: Kind, at: Time) -> Message {
        let order = self.order;
        let message = WorkOrderMessage {
            id: DeliveryId::new(),
            kind,
            at,
            words: words(order, &self.entry),
            work_order: MessageOrder {
                id: order.id,
                state: order.state,
                answer_by: order.answer_by,
                operator_name: &order.operator_name,
                vessel_id: order.vessel_id,
                vessel_name: &order.vessel_name,
                compass_name: &order.compass_name,
                port: &order.port,
                berth: order.berth.as_deref(),
                planned_at: order.planned_at,
                planned_until: order.planned_until,
                planned_at_local: order.planned_at_local.as_deref(),
                planned_until_local: order.planned_until_local.as_deref(),
                call_fit: order.call_fit,
            },
            entry: self.entry,
        };
        Message {
            id: message.id,
            kind,
            about: Some(order.id.0),
            body: json!(message).to_string(),
        }
    }
}
