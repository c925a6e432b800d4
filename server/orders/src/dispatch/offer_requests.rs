//! Requests and answers between an operator and firms.

use crate::dispatch::call_links::link_call_at;
use crate::dispatch::offer_sequence::{
    answer_by, require_future_job, send_next_offers, send_offers, share_deadline,
};
use crate::dispatch::port_call_check;
use crate::firms::{self, Requester, Visit};
use crate::work_orders::events::{
    Accepted, Boarding, Declined, OfferRound, OfferedFirm, OrderEvent, ProposalAccepted,
    ProposalDeclined, Proposed,
};
use crate::work_orders::new_order::{NewOffer, require_near_date};
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_update::Change;
use crate::work_orders::payload::exchange::{Exchange, NamedFirm, Terms};
use crate::work_orders::payload::hours::Hours;
use crate::work_orders::state::State;
use binnacle_platform::db::Tx;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::{is_control, optional_text, text};
use binnacle_platform::ids::{FirmId, OperatorId};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Most firms of an offer.
const MAX_FIRMS: usize = 20;
pub(crate) const MAX_ANSWER_HOURS: u32 = 720;
const MAX_FEE_EUR: f64 = 1e6;
/// Longest text of a message, in characters.
pub(crate) const MAX_MESSAGE: usize = 2000;

/// Acceptance or refusal.
#[derive(Clone, Debug, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = OfferAnswer, example = json!({
    "adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114", "text": "See you there."
}))]
pub(crate) struct OfferAnswer {
    /// Firm whose proposal the operator answers; optional if there is one only.
    #[serde(default)]
    pub firm_id: Option<FirmId>,
    /// Name of the adjuster, where a firm accepts.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub adjuster_name: Option<String>,
    /// Licence number.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub adjuster_licence: Option<String>,
    /// Text.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub text: Option<String>,
}

/// Proposal of other terms than offered.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = OfferProposal, example = json!({
    "terms": { "planned_at": "2026-11-22T13:00:00Z", "planned_until": "2026-11-22T16:00:00Z",
               "fee_eur": 900.0 },
    "text": "Our team is at Santander until noon."
}))]
pub(crate) struct Proposal {
    /// Terms: omitted ones stay as offered.
    pub terms: ProposedTerms,
    /// Text.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub text: Option<String>,
}

/// Terms that a firm proposes: at least one of these.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = ProposedTerms, example = json!({ "fee_eur": 900.0 }))]
pub(crate) struct ProposedTerms {
    /// Time of the job, if another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planned_at: Option<Time>,
    /// End of the job, within 24 hours; without it the job takes as long as offered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planned_until: Option<Time>,
    /// Berth, if another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub berth: Option<String>,
    /// Fee, euros, if another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0, maximum = 1_000_000)]
    pub fee_eur: Option<f64>,
}

impl NewOffer {
    /// Validates the offer: the operator works with all of the firms.
    pub(crate) async fn checked(self, tx: &mut Tx, operator: OperatorId) -> Result<OfferRound> {
        let invalid = |field, detail: String| Err(Error::Invalid { field, detail });
        if self.firms.is_empty() || self.firms.len() > MAX_FIRMS {
            return invalid("firms", format!("is not 1 to {MAX_FIRMS} firms"));
        }
        if !(1..=MAX_ANSWER_HOURS).contains(&self.answer_within_hours) {
            let hours = self.answer_within_hours;
            let detail = format!("{hours} is outside 1 to {MAX_ANSWER_HOURS}");
            return invalid("answer_within_hours", detail);
        }
        let mut firms: Vec<OfferedFirm> = Vec::new();
        for firm_id in self.firms {
            if firms.iter().any(|one| one.firm.firm_id == firm_id) {
                return invalid("firms", format!("{firm_id} is listed twice"));
            }
            let Some(firm_name) = firms::find_name(tx, operator, firm_id).await? else {
                return invalid(
                    "firms",
                    format!("{firm_id} is not a firm that works for you"),
                );
            };
            let fee_eur = if let Some(fee) = self.fees_eur.get(&firm_id) {
                Some(*fee)
            } else {
                let terms = firms::find_terms(tx, operator, firm_id).await?;
                terms.map(|terms| f64::from(terms.fee_eur))
            };
            let firm = NamedFirm { firm_id, firm_name };
            let team = self.teams.get(&firm_id).cloned();
            firms.push(OfferedFirm {
                firm,
                fee_eur,
                team,
            });
        }
        Ok(OfferRound {
            firms,
            answer_within_hours: self.answer_within_hours,
            at_once: self.at_once,
            text: optional_text("text", self.text.as_deref())?,
        })
    }
}

/// Refuses a firm that answers for another.
pub(crate) fn require_own_firm(tenant: Tenant, named: Option<FirmId>) -> Result<()> {
    match (tenant.firm(), named) {
        (Some(own), Some(firm)) if own != firm => Err(Error::Invalid {
            field: "firm_id",
            detail: format!("{firm} is not your firm"),
        }),
        _ => Ok(()),
    }
}

impl OfferAnswer {
    /// Validates the answer.
    ///
    /// # Errors
    /// [`Error::Invalid`] when a firm answers for another.
    pub(crate) fn checked(self, tenant: Tenant) -> Result<OfferAnswer> {
        require_own_firm(tenant, self.firm_id)?;
        let optional = |field, value: Option<String>| optional_text(field, value.as_deref());
        Ok(OfferAnswer {
            firm_id: self.firm_id,
            adjuster_name: optional("adjuster_name", self.adjuster_name)?,
            adjuster_licence: optional("adjuster_licence", self.adjuster_licence)?,
            text: optional("text", self.text)?,
        })
    }

    /// Exchange with a firm that contains the answer.
    pub(crate) fn into_exchange(self, firm: NamedFirm) -> Exchange {
        Exchange {
            adjuster_name: self.adjuster_name,
            adjuster_licence: self.adjuster_licence,
            text: self.text,
            ..Exchange::with(firm)
        }
    }
}

/// Validates terms with hours in the future. Without an end the job takes as long as `before`.
pub(crate) fn checked_terms(terms: Terms, before: Hours, now: Time) -> Result<Terms> {
    if terms.planned_at <= now {
        return Err(Error::Invalid {
            field: "planned_at",
            detail: format!("{} is over", terms.planned_at.0),
        });
    }
    require_near_date(terms.planned_at, now)?;
    let hours = match terms.planned_until {
        Some(until) => Hours::new(terms.planned_at, Some(until)).checked()?,
        None => before.moved_to(terms.planned_at),
    };
    checked_words(Terms {
        planned_until: Some(hours.until),
        ..terms
    })
}

/// Validates berth and fee; rounds the fee to cents.
fn checked_words(mut terms: Terms) -> Result<Terms> {
    if let Some(fee) = terms.fee_eur
        && !(0.0..=MAX_FEE_EUR).contains(&fee)
    {
        return Err(Error::Invalid {
            field: "fee_eur",
            detail: format!("{fee} is outside 0 to {MAX_FEE_EUR}"),
        });
    }
    terms.fee_eur = terms.fee_eur.map(|fee| (fee * 100.0).round() / 100.0);
    terms.berth = optional_text("berth", terms.berth.as_deref())?;
    Ok(terms)
}

impl Proposal {
    /// Validates a firm's proposal for an order that is planned in these hours.
    ///
    /// # Errors
    /// [`Error::Invalid`] when it proposes nothing, or invalid terms.
    pub(crate) fn checked(self, planned: Hours, now: Time) -> Result<CheckedProposal> {
        let new = self.terms;
        let has_hours = new.planned_at.is_some() || new.planned_until.is_some();
        let terms = Terms {
            planned_at: new.planned_at.unwrap_or(planned.from),
            planned_until: new.planned_until,
            berth: new.berth,
            fee_eur: new.fee_eur,
        };
        // Unchanged hours are not checked again: the firm may still accept them.
        let terms = if has_hours {
            checked_terms(terms, planned, now)?
        } else {
            checked_words(Terms {
                planned_until: Some(planned.until),
                ..terms
            })?
        };
        if !has_hours && terms.berth.is_none() && terms.fee_eur.is_none() {
            return Err(Error::Invalid {
                field: "terms",
                detail: "propose nothing: give planned_at, planned_until, berth or fee_eur"
                    .to_owned(),
            });
        }
        Ok(CheckedProposal {
            terms,
            text: optional_text("text", self.text.as_deref())?,
        })
    }
}

/// Proposal of a firm, with all terms.
pub(crate) struct CheckedProposal {
    terms: Terms,
    text: Option<String>,
}

impl Boarding {
    /// Validates the time of boarding.
    pub(crate) fn checked(self, now: Time) -> Result<Boarding> {
        let at = self.at.unwrap_or(now);
        if at > now {
            return Err(Error::Invalid {
                field: "at",
                detail: "lies in the future".to_owned(),
            });
        }
        Ok(Boarding {
            at: Some(at),
            text: optional_text("text", self.text.as_deref())?,
        })
    }
}

/// Validates the text of a message, which may have several lines.
pub(crate) fn checked_message(message: &str) -> Result<String> {
    let message = message.trim();
    if message.chars().any(|c| is_control(c) && c != '\n') || message.chars().count() > MAX_MESSAGE
    {
        return Err(Error::Invalid {
            field: "text",
            detail: format!("has control characters, or more than {MAX_MESSAGE} characters"),
        });
    }
    // Blank text is refused as elsewhere.
    if message.is_empty() {
        return text("text", message);
    }
    Ok(message.to_owned())
}

/// Offers an order, and sends the first offers.
///
/// # Errors
/// [`Error::WrongState`] when its time is past, or a firm has no team left or does not work on
/// that day.
pub(crate) async fn offer(change: &mut Change<'_>, mut offered: OfferRound) -> Result<()> {
    let hours = change.stored.summary.hours();
    require_future_job(change, hours.from)?;
    // All transactions lock firms in the same order.
    let mut firms: Vec<&mut OfferedFirm> = offered.firms.iter_mut().collect();
    firms.sort_by_key(|one| one.firm.firm_id.0);
    for one in firms {
        let job = TeamJob {
            firm: &one.firm,
            team: one.team.as_deref(),
            hours,
        };
        one.team = require_capacity(change, &job, Requester::Operator).await?;
    }
    change.append(OrderEvent::OfferRound(offered)).await?;
    // The first firm named receives the offer however short the notice.
    send_offers(change).await
}

/// Job that a firm is to do.
pub(crate) struct TeamJob<'a> {
    /// The firm.
    pub firm: &'a NamedFirm,
    /// Team that is expected, if it has a name.
    pub team: Option<&'a str>,
    /// Hours of the job.
    pub hours: Hours,
}

/// Refuses hours for which a firm has no team left. Returns the team, if it has a name.
pub(crate) async fn require_capacity(
    change: &mut Change<'_>,
    job: &TeamJob<'_>,
    requester: Requester,
) -> Result<Option<String>> {
    let summary = &change.stored.summary;
    let visit = Visit {
        operator: summary.operator_id,
        vessel: summary.vessel_id,
        order: summary.id,
        port: &summary.port,
        from: job.hours.from,
        until: job.hours.until,
        team: job.team,
    };
    let (firm, name) = (job.firm.firm_id, &job.firm.firm_name);
    firms::require_capacity(&mut change.tx, firm, name, &visit, requester).await
}

/// Answer of a firm to an offer.
pub(crate) enum FirmAnswer {
    Accept(OfferAnswer),
    Decline(OfferAnswer),
    Propose(CheckedProposal),
}

/// Applies a firm's answer.
///
/// # Errors
/// [`Error::WrongState`] when the firm has no open offer.
pub(crate) async fn answer_as_firm(
    change: &mut Change<'_>,
    firm: FirmId,
    answer: FirmAnswer,
) -> Result<()> {
    let offers = change.stored.state().offers;
    let offer = offers.to_firm(firm).ok_or(Error::NotFound("work order"))?;
    let wrong = |why: &str| Err(Error::WrongState(why.to_owned()));
    let gives_back = matches!(answer, FirmAnswer::Decline(_))
        && offer.state == OfferState::Accepted
        && change.stored.summary.state == State::Accepted;
    // A firm may withdraw its own proposal.
    let takes_back = matches!(answer, FirmAnswer::Decline(_) | FirmAnswer::Propose(_))
        && offer.state == OfferState::Proposed;
    if change.stored.summary.state == State::Cancelled {
        return wrong("the order is cancelled");
    }
    if offer.state != OfferState::Open && !gives_back && !takes_back {
        return wrong(offer.state.reason_closed());
    }
    if !gives_back && offer.answer_by.is_some_and(|by| by < change.now) {
        return wrong(OfferState::Lapsed.reason_closed());
    }
    let named_firm = offer.firm();
    let job = |hours| TeamJob {
        firm: &named_firm,
        team: offer.team.as_deref(),
        hours,
    };
    match answer {
        FirmAnswer::Accept(answer) => {
            let hours = change.stored.summary.hours();
            require_future_job(change, hours.from)?;
            let team = require_capacity(change, &job(hours), Requester::Firm).await?;
            let taken = Exchange {
                fee_eur: offer.fee_eur,
                team,
                ..answer.into_exchange(named_firm.clone())
            };
            change.append(OrderEvent::Accepted(Accepted(taken))).await
        }
        FirmAnswer::Decline(answer) => {
            change
                .append(OrderEvent::Declined(Declined(
                    answer.into_exchange(named_firm),
                )))
                .await?;
            send_next_offers(change).await
        }
        FirmAnswer::Propose(proposal) => {
            let hours = proposal.terms.hours();
            let team = require_capacity(change, &job(hours), Requester::Firm).await?;
            if hours != change.stored.summary.hours() {
                port_call_check::require_vessel_in_port(change, hours, "planned_at").await?;
            }
            let until = answer_by(change, offers.answer_within_hours, hours.from);
            let share = share_deadline(change, &offers, 0).await?;
            let until = share.map_or(until, |share| share.min(until));
            let proposed = Exchange {
                answer_by: Some(until),
                terms: Some(proposal.terms),
                team,
                text: proposal.text,
                ..Exchange::with(named_firm)
            };
            change
                .append(OrderEvent::Proposed(Proposed(proposed)))
                .await
        }
    }
}

/// Decision of an operator on a proposal.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Decision {
    Accept,
    Decline,
}

/// Applies an operator's answer to a proposal.
///
/// # Errors
/// [`Error::WrongState`] when there is no proposal, or it has lapsed.
pub(crate) async fn answer_as_operator(
    change: &mut Change<'_>,
    answer: OfferAnswer,
    decision: Decision,
) -> Result<()> {
    let offers = change.stored.state().offers;
    let mut proposed = offers.all.iter().filter(|offer| {
        let is_addressed = answer.firm_id.is_none_or(|firm| firm == offer.firm_id);
        is_addressed && offer.state == OfferState::Proposed
    });
    let wrong = |why: &str| Err(Error::WrongState(why.to_owned()));
    let Some(offer) = proposed.next() else {
        return wrong("there is no proposal to answer");
    };
    if proposed.next().is_some() {
        return Err(Error::Invalid {
            field: "firm_id",
            detail: "is required: more than one firm has proposed terms".to_owned(),
        });
    }
    if offer.answer_by.is_some_and(|by| by < change.now) {
        return wrong("the proposal has lapsed");
    }
    let mut exchange = Exchange {
        terms: offer.terms.clone(),
        text: answer.text,
        ..Exchange::with(offer.firm())
    };
    if decision == Decision::Accept {
        let (firm, fee_eur) = (exchange.firm.clone(), offer.fee());
        if let Some(terms) = &mut exchange.terms {
            // Terms that the firm omits stay as offered.
            terms.fee_eur = fee_eur;
            let hours = terms.hours();
            require_future_job(change, hours.from)?;
            let job = TeamJob {
                firm: &firm,
                team: offer.team.as_deref(),
                hours,
            };
            exchange.team = require_capacity(change, &job, Requester::Operator).await?;
            if hours != change.stored.summary.hours() {
                port_call_check::require_vessel_in_port(change, hours, "planned_at").await?;
                link_call_at(change, hours.from).await?;
            }
        }
        return change
            .append(OrderEvent::ProposalAccepted(ProposalAccepted(exchange)))
            .await;
    }
    change
        .append(OrderEvent::ProposalDeclined(ProposalDeclined(exchange)))
        .await?;
    send_next_offers(change).await
}
