//! Telling both sides of an order what happened: live, and by their webhooks.
//!
//! What always holds: news is written in the transaction that makes it true. A firm is
//! told of what is between it and the operator, and of everything else only while the
//! order is its own.

use crate::work_orders::log_entry::{Entry, OrderEvent};
use crate::work_orders::notification_text;
use crate::work_orders::offer_state::{Offer, OfferState, Offers};
use crate::work_orders::order::{State, Summary};
use crate::work_orders::store::StoredOrder;
use binnacle_adjustment::adjust::Verification;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::{self, Event};
use binnacle_platform::ids::{DeliveryId, FirmId, UserId};
use binnacle_platform::notices::{Notice, NoticesPublished};
use binnacle_platform::outbox::{Kind, Message};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use binnacle_platform::webhooks;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// An order as it was before a change.
pub(crate) struct Before {
    last_seq: i64,
    offers: Offers,
}

impl Before {
    pub(crate) fn of(whole: &StoredOrder) -> Before {
        Before {
            last_seq: whole.summary.last_seq,
            offers: whole.standing().offers,
        }
    }
}

impl Before {
    /// How the offer to a firm stood.
    fn was(&self, firm: FirmId) -> Option<OfferState> {
        self.offers.of(firm).map(|offer| offer.state)
    }
}

/// Tells of what was written since; the live events, to be published after the commit.
pub(crate) async fn tell(
    tx: &mut Tx,
    whole: &StoredOrder,
    before: &Before,
    now: Time,
) -> Result<Vec<Event>> {
    let summary = &whole.summary;
    let new = |entry: &&Entry| entry.seq > before.last_seq;
    let new: Vec<&Entry> = whole.log.iter().filter(new).collect();
    // The operator is told once of what several firms are told.
    let once = new.iter().copied().enumerate().filter(|(at, entry)| {
        let moved = |entry: &Entry| matches!(entry.content, OrderEvent::CallMoved(_));
        !moved(entry) || !new[..*at].iter().any(|earlier| moved(earlier))
    });
    let once: Vec<&Entry> = once.map(|(_, entry)| entry).collect();
    let offers = whole.standing().offers;
    let mut told = Vec::new();
    for entry in &once {
        if let Some(kind) = kind(&entry.content) {
            told.push(message(kind, summary, entry, now));
        }
    }
    let operator = Tenant::Operator(summary.operator_id);
    webhooks::announce(tx, operator, &told, now).await?;
    let by = author(&new);
    let notices = once.iter().filter_map(|entry| {
        let firm = entry.content.between().map(|said| said.firm.firm_id);
        notification_text::for_operator(summary, entry, firm.and_then(|firm| before.was(firm)))
    });
    let published = NoticesPublished {
        tenant: operator,
        notices: notices.collect(),
        by,
        at: now,
    };
    tx.publish(&published).await?;
    let order = (summary.vessel_id, summary.id);
    let mut live = vec![events::insert_of_order(tx, order, None, now).await?];
    // In the order of their ids: no two transactions wait for each other.
    for firm in firms(&before.offers, &offers) {
        let was = before.was(firm);
        let Some(offer) = offers.of(firm) else {
            continue;
        };
        let told = messages_for(summary, offer, was, &new, now);
        // Who was passed over was not asked.
        let passed = (was, offer.state) == (Some(OfferState::Waiting), OfferState::Lapsed);
        if told.is_empty() || passed {
            continue;
        }
        webhooks::announce(tx, Tenant::Firm(firm), &told, now).await?;
        let notices = notices_for(summary, offer, was, &new);
        let published = NoticesPublished {
            tenant: Tenant::Firm(firm),
            notices,
            by,
            at: now,
        };
        tx.publish(&published).await?;
        live.push(events::insert_of_order(tx, order, Some(firm), now).await?);
    }
    Ok(live)
}

fn firms(before: &Offers, after: &Offers) -> BTreeSet<FirmId> {
    let all = before.all.iter().chain(&after.all);
    all.map(|offer| offer.firm_id).collect()
}

fn messages_for(
    summary: &Summary,
    offer: &Offer,
    was: Option<OfferState>,
    new: &[&Entry],
    now: Time,
) -> Vec<Message> {
    let seen = summary.seen_with(offer);
    let mut told = Vec::new();
    for entry in new.iter().filter(|entry| offer.shows(entry)) {
        if let Some(kind) = kind(&entry.content) {
            told.push(message(kind, &seen, entry, now));
        }
    }
    if offer.is_withdrawn_since(was)
        && let Some(last) = new.last()
    {
        // Why is not the firm's business: another may have it.
        let body = json!({ "seq": last.seq, "kind": "withdrawn", "at": last.at });
        told.push(written(Kind::OrderWithdrawn, &seen, &body, now));
    }
    told
}

/// The same for the firm's people, in words.
fn notices_for(
    summary: &Summary,
    offer: &Offer,
    was: Option<OfferState>,
    new: &[&Entry],
) -> Vec<Notice> {
    let seen = summary.seen_with(offer);
    let theirs = new.iter().filter(|entry| offer.shows(entry));
    let mut told: Vec<Notice> = theirs
        .filter_map(|entry| notification_text::for_firm(&seen, entry, was))
        .collect();
    if offer.is_withdrawn_since(was) {
        told.extend(
            new.last()
                .map(|last| notification_text::withdrawn(&seen, last)),
        );
    }
    told
}

impl Offer {
    /// Whether the firm may know of a new entry.
    fn shows(&self, entry: &Entry) -> bool {
        let holds = self.state == OfferState::Accepted;
        let between = entry.content.between();
        between.map_or(holds, |said| said.firm.firm_id == self.firm_id)
    }

    fn is_withdrawn_since(&self, was: Option<OfferState>) -> bool {
        self.state == OfferState::Withdrawn && was.is_some_and(OfferState::is_seen)
    }
}

/// Who wrote it; none for the server itself.
fn author(new: &[&Entry]) -> Option<UserId> {
    new.last().and_then(|entry| entry.author.id).map(UserId)
}

fn kind(content: &OrderEvent) -> Option<Kind> {
    Some(match content {
        OrderEvent::OfferRound(_) => return None,
        OrderEvent::OfferSent(_) => Kind::OrderOffered,
        OrderEvent::Accepted(_)
        | OrderEvent::Declined(_)
        | OrderEvent::Proposed(_)
        | OrderEvent::ProposalAccepted(_)
        | OrderEvent::ProposalDeclined(_)
        | OrderEvent::RetimeAccepted(_)
        | OrderEvent::RetimeDeclined(_) => Kind::OrderAnswered,
        OrderEvent::Lapsed(_) | OrderEvent::RetimeLapsed(_) => Kind::OrderLapsed,
        OrderEvent::RetimeProposed(_) => Kind::OrderRetimeProposed,
        OrderEvent::CallMoved(_) => Kind::OrderCallMoved,
        OrderEvent::Message(_) => Kind::OrderMessage,
        OrderEvent::Completion(_) => Kind::OrderCompleted,
        OrderEvent::Verification(verified) => match verified.verification {
            Verification::Passed { .. } => Kind::OrderVerified,
            Verification::MoreNeeded { .. } => Kind::OrderUpdated,
            Verification::Alarm { .. } => Kind::OrderFailed,
        },
        OrderEvent::Closed(_) => Kind::OrderClosed,
        OrderEvent::Cancelled(_) => Kind::OrderCancelled,
        OrderEvent::Opened(_)
        | OrderEvent::OnBoard(_)
        | OrderEvent::BerthReading(_)
        | OrderEvent::Plan(_)
        | OrderEvent::Step(_)
        | OrderEvent::SecondReading(_)
        | OrderEvent::CorrectorSettings(_)
        | OrderEvent::Photo(_)
        | OrderEvent::Remark(_)
        | OrderEvent::Signature(_) => Kind::OrderUpdated,
    })
}

fn message(kind: Kind, summary: &Summary, entry: &Entry, now: Time) -> Message {
    let said = entry.content.between();
    let what = serde_json::to_value(&entry.content).ok();
    let what = what.and_then(|value| value.get("kind").cloned());
    let call = match &entry.content {
        OrderEvent::CallMoved(moved) => Some(&moved.call),
        _ => None,
    };
    let entry = json!({
        "seq": entry.seq, "kind": what, "at": entry.at, "by": entry.author.name,
        "firm_id": said.map(|said| said.firm.firm_id),
        "fee_eur": said.and_then(|said| said.fee_eur),
        "terms": said.and_then(|said| said.terms.as_ref()),
        "text": said.and_then(|said| said.text.as_ref()),
        "call": call,
    });
    written(kind, summary, &entry, now)
}

/// A message as it is sent: the order in short, and what happened to it.
fn written(kind: Kind, summary: &Summary, entry: &Value, now: Time) -> Message {
    let id = DeliveryId::new();
    let (state, answer_by): (State, Option<Time>) = (summary.state, summary.answer_by);
    let body = json!({
        "id": id, "kind": kind, "at": now,
        "work_order": {
            "id": summary.id, "state": state, "answer_by": answer_by,
            "operator_name": summary.operator_name,
            "vessel_id": summary.vessel_id, "vessel_name": summary.vessel_name,
            "compass_name": summary.compass_name, "port": summary.port, "berth": summary.berth,
            "planned_at": summary.planned_at, "call_fit": summary.call_fit,
        },
        "entry": entry,
    });
    Message {
        id,
        kind,
        order: Some(summary.id),
        body: body.to_string(),
    }
}
