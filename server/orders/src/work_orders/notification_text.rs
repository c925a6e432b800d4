//! What people are told of an order, in words, and on which side.
//!
//! What always holds: who does something is not told of it by us, but of a call that moves
//! all are; what is between the operator and one firm is told to no other.

use crate::dispatch::port_call_changes::{CallFit, CallMoved};
use crate::work_orders::log_entry::{Entry, OrderEvent};
use crate::work_orders::offer_state::{Exchange, OfferState};
use crate::work_orders::order::Summary;
use binnacle_adjustment::adjust::Verification;
use binnacle_platform::mail;
use binnacle_platform::notices::{Kind, Notice};
use std::fmt::Write;

/// Who reads it.
#[derive(Clone, Copy)]
enum Side {
    Operator,
    Firm,
}

/// What the operator's people are told of an entry; `was` is how the offer to the entry's
/// firm stood before.
pub(crate) fn for_operator(
    summary: &Summary,
    entry: &Entry,
    was: Option<OfferState>,
) -> Option<Notice> {
    let by_firm = entry.author.firm_id.is_some();
    let firm = |said: &Exchange| said.firm.firm_name.clone();
    let (kind, what) = match &entry.content {
        OrderEvent::Accepted(said) => (Kind::Answered, format!("{} accepts the job", firm(said))),
        OrderEvent::Declined(said) if by_firm && was == Some(OfferState::Accepted) => {
            (Kind::Answered, format!("{} gives the job back", firm(said)))
        }
        OrderEvent::Declined(said) if by_firm => {
            (Kind::Answered, format!("{} declines the job", firm(said)))
        }
        OrderEvent::Proposed(said) => (
            Kind::Answered,
            format!("{} proposes other terms", firm(said)),
        ),
        OrderEvent::Lapsed(said) if was == Some(OfferState::Waiting) => (
            Kind::AnswerLate,
            format!("{} cannot be asked in time", firm(said)),
        ),
        OrderEvent::Lapsed(said) if was == Some(OfferState::Proposed) => (
            Kind::AnswerLate,
            format!("no answer in time to the terms of {}", firm(said)),
        ),
        OrderEvent::Lapsed(said) => (
            Kind::AnswerLate,
            format!("no answer in time from {}", firm(said)),
        ),
        OrderEvent::RetimeAccepted(said) => (
            Kind::Answered,
            format!("{} agrees to another time", firm(said)),
        ),
        OrderEvent::RetimeDeclined(said) if by_firm => (
            Kind::Answered,
            format!("{} does not agree to another time", firm(said)),
        ),
        OrderEvent::RetimeLapsed(said) => (
            Kind::AnswerLate,
            format!("no answer in time from {} to another time", firm(said)),
        ),
        OrderEvent::CallMoved(moved) => (Kind::CallMoved, call_moved(moved).to_owned()),
        OrderEvent::Message(said) if by_firm => (Kind::Message, format!("{} writes", firm(said))),
        OrderEvent::OnBoard(_) => (Kind::OnBoard, "the adjuster is on board".to_owned()),
        OrderEvent::Completion(_) => (Kind::Completed, "adjusted, and signed".to_owned()),
        content => {
            let (kind, what) = verified(content)?;
            (kind, what.to_owned())
        }
    };
    Some(told(
        kind,
        &what,
        facts(summary, Side::Operator),
        summary,
        entry,
    ))
}

/// What a firm's people are told of an entry that they may see.
pub(crate) fn for_firm(
    summary: &Summary,
    entry: &Entry,
    was: Option<OfferState>,
) -> Option<Notice> {
    let by_firm = entry.author.firm_id.is_some();
    let (kind, what) = match &entry.content {
        OrderEvent::OfferSent(_) => (Kind::Offered, "a job is offered to you"),
        OrderEvent::ProposalAccepted(_) => (Kind::Answered, "your terms are agreed to"),
        OrderEvent::ProposalDeclined(_) => (Kind::Answered, "your terms are declined"),
        OrderEvent::Lapsed(_) if was == Some(OfferState::Proposed) => {
            (Kind::AnswerLate, "no answer in time to your terms")
        }
        OrderEvent::Lapsed(_) => (Kind::AnswerLate, "you have not answered in time"),
        OrderEvent::RetimeProposed(_) => (Kind::Offered, "another time is asked of you"),
        OrderEvent::RetimeDeclined(_) if !by_firm => {
            (Kind::Answered, "another time is asked of you no more")
        }
        OrderEvent::RetimeLapsed(_) => (
            Kind::AnswerLate,
            "you have not answered in time to another time",
        ),
        OrderEvent::CallMoved(moved) => (Kind::CallMoved, call_moved(moved)),
        OrderEvent::Message(_) if !by_firm => (Kind::Message, "the operator writes"),
        OrderEvent::Cancelled(_) => (Kind::Withdrawn, "the job is cancelled"),
        content => verified(content)?,
    };
    Some(told(kind, what, facts(summary, Side::Firm), summary, entry))
}

/// What a firm's people are told when its offer is taken back; why is not their business.
pub(crate) fn withdrawn(summary: &Summary, last: &Entry) -> Notice {
    let facts = facts(summary, Side::Firm);
    Notice {
        text: facts + "\nAnother firm may have it, or it is not to be done.\n",
        ..told(
            Kind::Withdrawn,
            "the offer is withdrawn",
            String::new(),
            summary,
            last,
        )
    }
}

fn call_moved(moved: &CallMoved) -> &'static str {
    match (&moved.call.is, moved.call.fit) {
        (None, _) => "the port call is withdrawn",
        (_, CallFit::Fits) => "the port call has moved",
        (_, CallFit::OtherHour) => "the port call has moved, another hour is needed",
        (_, CallFit::NeedsNewDay) => "the port call has moved, a new day is needed",
        (_, CallFit::NoCall) => "the port call is at another port now",
    }
}

fn verified(content: &OrderEvent) -> Option<(Kind, &'static str)> {
    let OrderEvent::Verification(verified) = content else {
        return None;
    };
    match verified.verification {
        Verification::Passed { .. } => Some((Kind::Verified, "verified at sea")),
        Verification::Alarm { .. } => Some((
            Kind::VerificationFailed,
            "the sea does not confirm the adjustment",
        )),
        Verification::MoreNeeded { .. } => None,
    }
}

fn told(kind: Kind, what: &str, facts: String, summary: &Summary, entry: &Entry) -> Notice {
    let mut text = facts;
    if let Some(said) = said(&entry.content) {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{}: {said}\n", entry.author.name);
    }
    Notice {
        kind,
        urgent: false,
        subject: format!("{}: {what} at {}", summary.vessel_name, summary.port),
        text,
        path: format!("/work-orders/{}", summary.id),
        vessel: summary.vessel_id,
        order: Some(summary.id),
        alert: None,
    }
}

/// What is asked for, a fact on each line.
fn facts(summary: &Summary, reader: Side) -> String {
    let berth = summary.berth.as_deref();
    let berth = berth.map_or_else(String::new, |berth| format!(", berth {berth}"));
    let mut lines = vec![
        format!("Vessel:    {}", summary.vessel_name),
        format!("Compass:   {}", summary.compass_name),
        format!("Port:      {}{berth}", summary.port),
        format!("Planned:   {}", summary.planned_at.to_the_minute()),
    ];
    match (reader, &summary.firm) {
        (Side::Firm, _) => lines.push(format!("Operator:  {}", summary.operator_name)),
        (Side::Operator, Some(firm)) => lines.push(format!("Firm:      {firm}")),
        (Side::Operator, None) => {}
    }
    if let Some(by) = summary.answer_by {
        lines.push(format!("Answer by: {}", by.to_the_minute()));
    }
    lines
        .iter()
        .map(|line| mail::one_line(line) + "\n")
        .collect()
}

/// What was said, and what is proposed, in words.
fn said(content: &OrderEvent) -> Option<String> {
    if let OrderEvent::Verification(verified) = content {
        return Some(verified.words.clone());
    }
    if let OrderEvent::Cancelled(said) = content {
        return Some(said.text.clone());
    }
    let said = content.between()?;
    let terms = said.terms.as_ref().map(|terms| {
        let berth = terms.berth.as_deref();
        let berth = berth.map_or_else(String::new, |berth| format!(", berth {berth}"));
        let fee = terms.fee_eur;
        let fee = fee.map_or_else(String::new, |eur| format!(", for {eur:.2} euros"));
        format!("{}{berth}{fee}.", terms.planned_at.to_the_minute())
    });
    let fee = said.fee_eur.map(|eur| format!("For {eur:.2} euros."));
    let words = fee.into_iter().chain(terms).chain(said.text.clone());
    let words: Vec<String> = words.collect();
    (!words.is_empty()).then(|| words.join(" "))
}
