//! Sequence of offers to firms, and their deadlines.

use crate::firms;
use crate::work_orders::events::{Lapsed, OfferSent, OrderEvent};
use crate::work_orders::offers::{Offer, OfferState, Offers};
use crate::work_orders::order_update::Change;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::state::State;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::FirmId;
use binnacle_platform::time::Time;

const HOUR_S: f64 = 3600.0;

/// Deadline for an answer to an offer that is sent now.
fn deadline(change: &Change<'_>, hours: u32) -> Time {
    Time(change.now.0.plus_seconds(f64::from(hours) * HOUR_S))
}

/// Refuses a job whose time is past.
pub(crate) fn require_future_job(change: &Change<'_>, at: Time) -> Result<()> {
    if latest_acceptance(at) > change.now {
        return Ok(());
    }
    Err(Error::WrongState(format!(
        "the job was planned for {}, which is past: it needs another time",
        at.to_the_minute()
    )))
}

/// Latest acceptance of a job that should have begun, for an adjuster already on the quay.
fn latest_acceptance(at: Time) -> Time {
    Time(at.0.plus_seconds(HOUR_S))
}

/// Deadline for an answer: the begin of the job at the latest, if that is ahead or just past.
pub(crate) fn answer_by(change: &Change<'_>, within_hours: u32, at: Time) -> Time {
    let deadline = deadline(change, within_hours);
    let ends = if at > change.now {
        at
    } else {
        latest_acceptance(at)
    };
    if ends > change.now {
        deadline.min(ends)
    } else {
        deadline
    }
}

/// Deadline that leaves time for the firms after the next `sent` ones: the time until the job,
/// less their notice, is shared among all. `None` if nobody follows.
pub(crate) async fn share_deadline(
    change: &mut Change<'_>,
    offers: &Offers,
    sent: usize,
) -> Result<Option<Time>> {
    let at = change.stored.summary.planned_at;
    let left_s = at.0.seconds_since(change.now.0);
    let (mut turns, mut share_s) = (1.0, f64::INFINITY);
    let waiting = offers.all.iter();
    let waiting = waiting.filter(|offer| offer.state == OfferState::Waiting);
    for offer in waiting.skip(sent) {
        let lead_s = lead_time_s(change, offer.firm_id).await?;
        if left_s > lead_s {
            turns += 1.0;
            share_s = share_s.min((left_s - lead_s) / turns);
        }
    }
    let ends = |share_s: f64| Time(change.now.0.plus_seconds(share_s.floor()));
    Ok(share_s.is_finite().then(|| ends(share_s)))
}

/// Notice that a firm requires by its terms, seconds.
async fn lead_time_s(change: &mut Change<'_>, firm: FirmId) -> Result<f64> {
    let operator = change.stored.summary.operator_id;
    let terms = firms::find_terms(&mut change.tx, operator, firm).await?;
    Ok(terms.map_or(0.0, |terms| terms.lead_time_h * HOUR_S))
}

/// Returns whether the job is further ahead than this.
fn is_in_time(change: &Change<'_>, lead_s: f64) -> bool {
    let at = change.stored.summary.planned_at;
    at.0.seconds_since(change.now.0) > lead_s
}

/// Sends the next offers, if no other offer is open. Firms whose notice is too short are passed
/// over.
pub(crate) async fn send_next_offers(change: &mut Change<'_>) -> Result<()> {
    let offers = change.stored.state().offers;
    if offers.state() == State::Declined {
        let waiting = offers.all.into_iter();
        for offer in waiting.filter(|offer| offer.state == OfferState::Waiting) {
            let lead_s = lead_time_s(change, offer.firm_id).await?;
            if is_in_time(change, lead_s) {
                continue;
            }
            let text = if is_in_time(change, 0.0) {
                let hours = lead_s / HOUR_S;
                format!("not asked: it requires {hours} h notice")
            } else {
                "not asked: the time of the job is past".to_owned()
            };
            let passed = Exchange {
                text: Some(text),
                ..Exchange::with(offer.firm())
            };
            change.append(OrderEvent::Lapsed(Lapsed(passed))).await?;
        }
    }
    send_offers(change).await
}

/// Sends the next offers, if any, with their deadlines.
pub(crate) async fn send_offers(change: &mut Change<'_>) -> Result<()> {
    let offers = change.stored.state().offers;
    let next: Vec<Offer> = offers.next().cloned().collect();
    if next.is_empty() {
        return Ok(());
    }
    let at = change.stored.summary.planned_at;
    let until = answer_by(change, offers.answer_within_hours, at);
    let share = share_deadline(change, &offers, next.len()).await?;
    let answer_by = share.map_or(until, |share| share.min(until));
    for next in next {
        let sent = Exchange {
            answer_by: Some(answer_by),
            fee_eur: next.fee_eur,
            team: next.team.clone(),
            text: next.text.clone(),
            ..Exchange::with(next.firm())
        };
        change
            .append(OrderEvent::OfferSent(OfferSent(sent)))
            .await?;
    }
    Ok(())
}
