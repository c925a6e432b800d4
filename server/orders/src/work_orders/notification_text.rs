//! Notifications of an order's events, in words.
//!
//! Invariants: nobody is notified of their own action, except of a moved port call, which
//! everybody is notified of. An exchange with one firm is shown to no other.

use crate::work_orders::events::{Circumstances, Headline};
use crate::work_orders::log::entry::Entry;
use crate::work_orders::notice_kinds;
use crate::work_orders::offers::OfferState;
use crate::work_orders::summary::Summary;
use binnacle_platform::mail;
use binnacle_platform::notices::Notice;
use std::fmt::Write;

/// Reader of a notification.
#[derive(Clone, Copy)]
enum Reader {
    Operator,
    Firm,
}

/// Returns the notification of an entry for the operator's people. `offer_before` is the
/// state of the offer to the entry's firm before it.
pub(crate) fn for_operator(
    summary: &Summary,
    entry: &Entry,
    offer_before: Option<OfferState>,
) -> Option<Notice> {
    let event = entry.content.event();
    let headline = event.operator_headline(circumstances(entry, offer_before))?;
    Some(notice(
        &headline,
        facts(summary, Reader::Operator),
        summary,
        entry,
    ))
}

/// Returns the notification of an entry for the people of a firm that may see it.
pub(crate) fn for_firm(
    summary: &Summary,
    entry: &Entry,
    offer_before: Option<OfferState>,
) -> Option<Notice> {
    let event = entry.content.event();
    let headline = event.firm_headline(circumstances(entry, offer_before))?;
    Some(notice(
        &headline,
        facts(summary, Reader::Firm),
        summary,
        entry,
    ))
}

fn circumstances(entry: &Entry, offer_before: Option<OfferState>) -> Circumstances {
    Circumstances {
        by_firm: entry.author.firm_id.is_some(),
        offer_before,
    }
}

/// Returns the notification of a withdrawn offer for the firm's people. It keeps the reason
/// confidential.
pub(crate) fn withdrawn(summary: &Summary, last: &Entry) -> Notice {
    let headline = Headline::new(notice_kinds::WITHDRAWN, "the offer is withdrawn");
    let facts = facts(summary, Reader::Firm);
    Notice {
        text: facts + "\nAnother firm may have the job, or it is cancelled.\n",
        ..notice(&headline, String::new(), summary, last)
    }
}

fn notice(headline: &Headline, facts: String, summary: &Summary, entry: &Entry) -> Notice {
    let mut text = facts;
    if let Some(quote) = entry.content.event().quote(&summary.port) {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{}: {quote}\n", entry.author.name);
    }
    Notice {
        kind: headline.kind,
        urgent: false,
        subject: format!(
            "{}: {} at {}",
            summary.vessel_name, headline.words, summary.port
        ),
        text,
        path: format!("/work-orders/{}", summary.id),
        vessel: Some(summary.vessel_id),
        about: Some(summary.id.0),
    }
}

/// Facts of the order, one on each line.
fn facts(summary: &Summary, reader: Reader) -> String {
    let berth = summary.berth.as_deref();
    let berth = berth.map_or_else(String::new, |berth| format!(", berth {berth}"));
    let mut lines = vec![
        format!("Vessel:    {}", summary.vessel_name),
        format!("Compass:   {}", summary.compass_name),
        format!("Port:      {}{berth}", summary.port),
        format!("Planned:   {}", summary.hours().describe(&summary.port)),
    ];
    match (reader, &summary.firm) {
        (Reader::Firm, _) => lines.push(format!("Operator:  {}", summary.operator_name)),
        (Reader::Operator, Some(firm)) => lines.push(format!("Firm:      {firm}")),
        (Reader::Operator, None) => {}
    }
    if let Some(by) = summary.answer_by {
        lines.push(format!("Answer by: {}", by.to_the_minute()));
    }
    lines
        .iter()
        .map(|line| mail::one_line(line) + "\n")
        .collect()
}
