//! Publication of an order's changes: live events, webhooks and notifications for both sides.
//!
//! Invariants: all of it is written in the transaction of the change. A firm is informed of
//! exchanges with the operator, and of everything else only while it has the order.

use crate::event_kinds;
use crate::work_orders::events::Audience;
use crate::work_orders::log::entry::Entry;
use crate::work_orders::message_kinds;
use crate::work_orders::notification_text;
use crate::work_orders::offers::{Offer, OfferState, Offers};
use crate::work_orders::store::StoredOrder;
use crate::work_orders::summary::Summary;
use crate::work_orders::webhook_message::MessageEntry;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::{self, Event, NewEvent};
use binnacle_platform::ids::{FirmId, UserId};
use binnacle_platform::notices::{Notice, NoticesPublished};
use binnacle_platform::outbox::Message;
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use binnacle_platform::webhooks;
use std::collections::BTreeSet;

/// Order as it was before a change.
pub(crate) struct OrderBefore {
    last_seq: i64,
    offers: Offers,
}

impl OrderBefore {
    pub(crate) fn from_order(stored: &StoredOrder) -> OrderBefore {
        OrderBefore {
            last_seq: stored.summary.last_seq,
            offers: stored.state().offers,
        }
    }

    /// State of the offer to a firm.
    fn offer_state(&self, firm: FirmId) -> Option<OfferState> {
        self.offers.to_firm(firm).map(|offer| offer.state)
    }
}

/// Writes the webhooks, notifications and live events of the entries since `before`.
/// Returns the live events, to be published after the commit.
pub(crate) async fn publish_changes(
    tx: &mut Tx,
    stored: &StoredOrder,
    before: &OrderBefore,
    now: Time,
) -> Result<Vec<Event>> {
    let summary = &stored.summary;
    let new = |entry: &&Entry| entry.seq > before.last_seq;
    let new: Vec<&Entry> = stored.log.iter().filter(new).collect();
    let once = without_repetitions(&new);
    let offers = stored.state().offers;
    let mut messages = Vec::new();
    for entry in &once {
        if let Some(kind) = entry.content.event().webhook() {
            messages.push(MessageEntry::of(entry).about(summary).queued(kind, now));
        }
    }
    let operator = Tenant::Operator(summary.operator_id);
    webhooks::announce(tx, operator, &messages, now).await?;
    let by = author(&new);
    let notices = once.iter().filter_map(|entry| {
        let exchange = entry.content.event().exchange();
        let offer_before = exchange.and_then(|exchange| before.offer_state(exchange.firm.firm_id));
        notification_text::for_operator(summary, entry, offer_before)
    });
    let published = NoticesPublished {
        tenant: operator,
        notices: notices.collect(),
        by,
        at: now,
    };
    tx.publish(&published).await?;
    let event = live_event(summary, None);
    let mut live = vec![events::insert_event(tx, event, now).await?];
    // In the order of their ids, so that no two transactions wait for each other.
    for firm in firms(&before.offers, &offers) {
        let offer_before = before.offer_state(firm);
        let Some(offer) = offers.to_firm(firm) else {
            continue;
        };
        let messages = messages_for(summary, offer, offer_before, &new, now);
        // A firm that was passed over never received an offer.
        let passed = (offer_before, offer.state) == (Some(OfferState::Waiting), OfferState::Lapsed);
        if messages.is_empty() || passed {
            continue;
        }
        webhooks::announce(tx, Tenant::Firm(firm), &messages, now).await?;
        let notices = notices_for(summary, offer, offer_before, &new);
        let published = NoticesPublished {
            tenant: Tenant::Firm(firm),
            notices,
            by,
            at: now,
        };
        tx.publish(&published).await?;
        let event = live_event(summary, Some(firm));
        live.push(events::insert_event(tx, event, now).await?);
    }
    Ok(live)
}

/// Returns the live event of a change, for the operator or for one firm.
fn live_event(summary: &Summary, firm_id: Option<FirmId>) -> NewEvent {
    NewEvent {
        vessel_id: summary.vessel_id,
        kind: event_kinds::WORK_ORDER,
        about: Some(summary.id.0),
        firm_id,
    }
}

/// Returns the entries for the operator: of one that the log repeats for each firm, the
/// first.
fn without_repetitions<'a>(new: &[&'a Entry]) -> Vec<&'a Entry> {
    let is_repeated = |entry: &Entry| entry.content.event().is_repeated_per_firm();
    let once = new.iter().copied().enumerate().filter(|(at, entry)| {
        !is_repeated(entry) || !new[..*at].iter().any(|earlier| is_repeated(earlier))
    });
    once.map(|(_, entry)| entry).collect()
}

fn firms(before: &Offers, after: &Offers) -> BTreeSet<FirmId> {
    let all = before.all.iter().chain(&after.all);
    all.map(|offer| offer.firm_id).collect()
}

/// Returns the webhook messages for a firm.
fn messages_for(
    summary: &Summary,
    offer: &Offer,
    offer_before: Option<OfferState>,
    new: &[&Entry],
    now: Time,
) -> Vec<Message> {
    let seen = summary.seen_with(offer);
    let mut messages = Vec::new();
    for entry in new.iter().filter(|entry| offer.shows(entry)) {
        if let Some(kind) = entry.content.event().webhook() {
            messages.push(MessageEntry::of(entry).about(&seen).queued(kind, now));
        }
    }
    if offer.is_withdrawn_since(offer_before)
        && let Some(last) = new.last()
    {
        // The reason is confidential: another firm may have it.
        let entry = MessageEntry::withdrawal(last);
        messages.push(entry.about(&seen).queued(message_kinds::WITHDRAWN, now));
    }
    messages
}

/// Returns the notifications for a firm's people.
fn notices_for(
    summary: &Summary,
    offer: &Offer,
    offer_before: Option<OfferState>,
    new: &[&Entry],
) -> Vec<Notice> {
    let seen = summary.seen_with(offer);
    let theirs = new.iter().filter(|entry| offer.shows(entry));
    let mut notices: Vec<Notice> = theirs
        .filter_map(|entry| notification_text::for_firm(&seen, entry, offer_before))
        .collect();
    if offer.is_withdrawn_since(offer_before) {
        let last = new.last();
        notices.extend(last.map(|last| notification_text::withdrawn(&seen, last)));
    }
    notices
}

impl Offer {
    /// Returns whether the firm is informed of a new entry.
    fn shows(&self, entry: &Entry) -> bool {
        match entry.content.event().audience() {
            Audience::Operator => false,
            Audience::Firm(addressee) => addressee == self.firm_id,
            Audience::Parties => self.state == OfferState::Accepted,
        }
    }

    fn is_withdrawn_since(&self, before: Option<OfferState>) -> bool {
        self.state == OfferState::Withdrawn && before.is_some_and(OfferState::is_seen)
    }
}

/// Author of the last entry; `None` for the server itself.
fn author(new: &[&Entry]) -> Option<UserId> {
    new.last().and_then(|entry| entry.author.id).map(UserId)
}
