//! What is asked and answered between an operator and firms, as requests have it.

use crate::dispatch::offer_sequence::{answer_by, ask, ask_next, must_be_ahead, share_ends};
use crate::dispatch::port_call_check;
use crate::dispatch::reschedule::at_its_call;
use crate::firms::{self, Told, Visit};
use crate::work_orders::log_entry::Content;
use crate::work_orders::offer_state::{Asked, Between, OfferState, Offered, OfferedTo, Terms};
use crate::work_orders::order::{State, must_be_near};
use crate::work_orders::order_update::Change;
use binnacle_platform::db::Tx;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::{is_control, optional_text, text};
use binnacle_platform::ids::{FirmId, OperatorId};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// So many firms at most.
const MOST_FIRMS: usize = 20;
pub(crate) const LONGEST_H: u32 = 720;
const MOST_EUR: f64 = 1e6;
/// Longest text of a message, in characters.
pub(crate) const MAX_MESSAGE: usize = 2000;

/// An order to be offered to firms.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewOffer, example = json!({
    "firms": ["0199aa00-0000-7000-8000-000000000003"], "answer_within_hours": 48
}))]
pub struct NewOffer {
    /// The firms, in the order in which they are asked: 1 to 20 that you work with.
    pub firms: Vec<FirmId>,
    /// So long each has for an answer, 1 to 720 hours; then the next is asked.
    #[serde(default = "two_days")]
    #[schema(minimum = 1, maximum = 720)]
    pub answer_within_hours: u32,
    /// Ask all of them at once: the first to accept has it.
    #[serde(default)]
    pub at_once: bool,
    /// What is said to them.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub text: Option<String>,
    /// The fees that a plan has for some of them; for others, what their terms say for a
    /// compass alone.
    #[serde(skip)]
    pub fees_eur: BTreeMap<FirmId, f64>,
}

pub(crate) fn two_days() -> u32 {
    48
}

/// A yes or a no.
#[derive(Clone, Debug, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = OfferAnswer, example = json!({
    "adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114", "text": "See you there."
}))]
pub(crate) struct Answer {
    /// Whose proposal an operator answers; may be left out where there is one.
    #[serde(default)]
    pub firm_id: Option<FirmId>,
    /// Who will come, where a firm accepts.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub adjuster_name: Option<String>,
    /// The number of their licence.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub adjuster_licence: Option<String>,
    /// In words.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub text: Option<String>,
}

/// Other terms than were offered.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = OfferProposal, example = json!({
    "terms": { "planned_at": "2026-11-22T13:00:00Z", "fee_eur": 900.0 },
    "text": "Our team is at Santander until noon."
}))]
pub(crate) struct Proposal {
    /// The terms: what is left out is as it was offered.
    pub terms: NewTerms,
    /// In words.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub text: Option<String>,
}

/// What a firm would have otherwise: at least one of these.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = ProposedTerms, example = json!({ "fee_eur": 900.0 }))]
pub(crate) struct NewTerms {
    /// When it is to be done, if at another time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planned_at: Option<Time>,
    /// The berth, if another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub berth: Option<String>,
    /// The fee, euros, if another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0, maximum = 1_000_000)]
    pub fee_eur: Option<f64>,
}

/// When the adjuster went on board.
#[derive(Clone, Debug, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = OnBoard, example = json!({ "text": "Gangway on the starboard side." }))]
pub struct Boarded {
    /// When; now where it is not said.
    #[serde(default)]
    pub at: Option<Time>,
    /// In words.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub text: Option<String>,
}

impl NewOffer {
    /// The offer, if the operator works with all of the firms.
    pub(crate) async fn checked(self, tx: &mut Tx, operator: OperatorId) -> Result<Offered> {
        let invalid = |field, detail: String| Err(Error::Invalid { field, detail });
        if self.firms.is_empty() || self.firms.len() > MOST_FIRMS {
            return invalid("firms", format!("is not 1 to {MOST_FIRMS} firms"));
        }
        if !(1..=LONGEST_H).contains(&self.answer_within_hours) {
            let hours = self.answer_within_hours;
            let detail = format!("{hours} is outside 1 to {LONGEST_H}");
            return invalid("answer_within_hours", detail);
        }
        let mut firms: Vec<OfferedTo> = Vec::new();
        for firm_id in self.firms {
            if firms.iter().any(|one| one.firm.firm_id == firm_id) {
                return invalid("firms", format!("{firm_id} stands there twice"));
            }
            let Some(firm_name) = firms::name_for(tx, operator, firm_id).await? else {
                return invalid("firms", format!("{firm_id} is no firm that you work with"));
            };
            let fee_eur = if let Some(fee) = self.fees_eur.get(&firm_id) {
                Some(*fee)
            } else {
                let terms = firms::terms_for(tx, operator, firm_id).await?;
                terms.map(|terms| f64::from(terms.fee_eur))
            };
            let firm = Asked { firm_id, firm_name };
            firms.push(OfferedTo { firm, fee_eur });
        }
        Ok(Offered {
            firms,
            answer_within_hours: self.answer_within_hours,
            at_once: self.at_once,
            text: optional_text("text", self.text.as_deref())?,
        })
    }
}

/// Refuses a firm that speaks for another.
pub(crate) fn must_be_own(tenant: Tenant, named: Option<FirmId>) -> Result<()> {
    match (tenant.firm(), named) {
        (Some(own), Some(firm)) if own != firm => Err(Error::Invalid {
            field: "firm_id",
            detail: format!("{firm} is not your firm"),
        }),
        _ => Ok(()),
    }
}

impl Answer {
    /// The same, its words trimmed.
    ///
    /// # Errors
    /// [`Error::Invalid`] where a firm answers for another.
    pub(crate) fn checked(self, tenant: Tenant) -> Result<Answer> {
        must_be_own(tenant, self.firm_id)?;
        let optional = |field, value: Option<String>| optional_text(field, value.as_deref());
        Ok(Answer {
            firm_id: self.firm_id,
            adjuster_name: optional("adjuster_name", self.adjuster_name)?,
            adjuster_licence: optional("adjuster_licence", self.adjuster_licence)?,
            text: optional("text", self.text)?,
        })
    }

    /// What it says of a firm.
    pub(crate) fn between(self, firm: Asked) -> Between {
        Between {
            adjuster_name: self.adjuster_name,
            adjuster_licence: self.adjuster_licence,
            text: self.text,
            ..Between::with(firm)
        }
    }
}

/// Terms at a time to come.
pub(crate) fn checked_terms(terms: Terms, now: Time) -> Result<Terms> {
    if terms.planned_at <= now {
        return Err(Error::Invalid {
            field: "planned_at",
            detail: format!("{} is over", terms.planned_at.0),
        });
    }
    must_be_near(terms.planned_at, now)?;
    checked_words(terms)
}

/// Terms, their berth trimmed, for a fee that can be, in whole cents.
fn checked_words(mut terms: Terms) -> Result<Terms> {
    if let Some(fee) = terms.fee_eur
        && !(0.0..=MOST_EUR).contains(&fee)
    {
        return Err(Error::Invalid {
            field: "fee_eur",
            detail: format!("{fee} is outside 0 to {MOST_EUR}"),
        });
    }
    terms.fee_eur = terms.fee_eur.map(|fee| (fee * 100.0).round() / 100.0);
    terms.berth = optional_text("berth", terms.berth.as_deref())?;
    Ok(terms)
}

impl Proposal {
    /// What a firm proposes for an order that is planned for some time, and its words.
    ///
    /// # Errors
    /// [`Error::Invalid`] where it proposes nothing, or what cannot be.
    pub(crate) fn checked(self, planned_at: Time, now: Time) -> Result<Proposed> {
        let new = self.terms;
        let terms = Terms {
            planned_at: new.planned_at.unwrap_or(planned_at),
            berth: new.berth,
            fee_eur: new.fee_eur,
        };
        // A time that stands is not judged again: the firm may still say yes to it.
        let terms = match new.planned_at {
            Some(_) => checked_terms(terms, now)?,
            None => checked_words(terms)?,
        };
        if new.planned_at.is_none() && terms.berth.is_none() && terms.fee_eur.is_none() {
            return Err(Error::Invalid {
                field: "terms",
                detail: "say nothing else: give planned_at, berth or fee_eur".to_owned(),
            });
        }
        Ok(Proposed {
            terms,
            text: optional_text("text", self.text.as_deref())?,
        })
    }
}

/// What a firm proposes, whole.
pub(crate) struct Proposed {
    terms: Terms,
    text: Option<String>,
}

impl Boarded {
    /// The same at a moment that can be.
    pub(crate) fn checked(self, now: Time) -> Result<Boarded> {
        let at = self.at.unwrap_or(now);
        if at > now {
            return Err(Error::Invalid {
                field: "at",
                detail: "lies in the future".to_owned(),
            });
        }
        Ok(Boarded {
            at: Some(at),
            text: optional_text("text", self.text.as_deref())?,
        })
    }
}

/// What is said in a message: lines of text.
pub(crate) fn message(said: &str) -> Result<String> {
    let said = said.trim();
    if said.chars().any(|c| is_control(c) && c != '\n') || said.chars().count() > MAX_MESSAGE {
        return Err(Error::Invalid {
            field: "text",
            detail: format!("has control characters, or more than {MAX_MESSAGE} characters"),
        });
    }
    // What is blank is refused as any text is.
    if said.is_empty() {
        return text("text", said);
    }
    Ok(said.to_owned())
}

/// Offers an order, and asks whom it is the turn of.
///
/// # Errors
/// [`Error::WrongState`] when its time is over, or one of the firms has no team left that day
/// or does not work then.
pub(crate) async fn offer(change: &mut Change<'_>, offered: Offered) -> Result<()> {
    let at = change.whole.summary.planned_at;
    must_be_ahead(change, at)?;
    // Everybody locks them in one order.
    let mut firms: Vec<&Asked> = offered.firms.iter().map(|one| &one.firm).collect();
    firms.sort_by_key(|firm| firm.firm_id.0);
    for firm in firms {
        must_have_room(change, firm, at, Told::Operator).await?;
    }
    change.append(Content::Offered(offered)).await?;
    // Whom the operator names first is asked at however short notice.
    ask(change).await
}

/// Refuses a time at which a firm has no team left.
pub(crate) async fn must_have_room(
    change: &mut Change<'_>,
    firm: &Asked,
    at: Time,
    told: Told,
) -> Result<()> {
    let summary = &change.whole.summary;
    let visit = Visit {
        operator: summary.operator_id,
        vessel: summary.vessel_id,
        port: &summary.port,
        at,
    };
    let name = (firm.firm_id, firm.firm_name.as_str());
    firms::must_have_room(&mut change.tx, name, &visit, told).await
}

/// A firm's yes or no, or its other terms.
pub(crate) enum FirmSays {
    Yes(Answer),
    No(Answer),
    Instead(Proposed),
}

/// Takes a firm's answer.
///
/// # Errors
/// [`Error::WrongState`] when it is not asked, or not any more.
pub(crate) async fn firm_says(change: &mut Change<'_>, firm: FirmId, says: FirmSays) -> Result<()> {
    let offers = change.whole.standing().offers;
    let offer = offers.of(firm).ok_or(Error::NotFound("work order"))?;
    let wrong = |why: &str| Err(Error::WrongState(why.to_owned()));
    let gives_back = matches!(says, FirmSays::No(_))
        && offer.state == OfferState::Accepted
        && change.whole.summary.state == State::Accepted;
    // A firm may think better of its own proposal.
    let takes_back = matches!(says, FirmSays::No(_) | FirmSays::Instead(_))
        && offer.state == OfferState::Proposed;
    if change.whole.summary.state == State::Cancelled {
        return wrong("the order is cancelled");
    }
    if offer.state != OfferState::Open && !gives_back && !takes_back {
        return wrong(offer.state.why_not());
    }
    if !gives_back && offer.answer_by.is_some_and(|by| by < change.now) {
        return wrong(OfferState::Lapsed.why_not());
    }
    let asked = offer.firm();
    match says {
        FirmSays::Yes(answer) => {
            let at = change.whole.summary.planned_at;
            must_be_ahead(change, at)?;
            must_have_room(change, &asked, at, Told::Firm).await?;
            let taken = Between {
                fee_eur: offer.fee_eur,
                ..answer.between(asked)
            };
            change.append(Content::Accepted(taken)).await
        }
        FirmSays::No(answer) => {
            change
                .append(Content::Declined(answer.between(asked)))
                .await?;
            ask_next(change).await
        }
        FirmSays::Instead(proposal) => {
            let at = proposal.terms.planned_at;
            must_have_room(change, &asked, at, Told::Firm).await?;
            if at != change.whole.summary.planned_at {
                port_call_check::must_be_there(change, at, "planned_at").await?;
            }
            let until = answer_by(change, offers.answer_within_hours, at);
            let share = share_ends(change, &offers, 0).await?;
            let until = share.map_or(until, |share| share.min(until));
            let proposed = Between {
                answer_by: Some(until),
                terms: Some(proposal.terms),
                text: proposal.text,
                ..Between::with(asked)
            };
            change.append(Content::Proposed(proposed)).await
        }
    }
}

/// Takes an operator's yes or no to what a firm has proposed.
///
/// # Errors
/// [`Error::WrongState`] when nothing is proposed, or it has lapsed.
pub(crate) async fn operator_says(
    change: &mut Change<'_>,
    answer: Answer,
    yes: bool,
) -> Result<()> {
    let offers = change.whole.standing().offers;
    let mut proposed = offers.all.iter().filter(|offer| {
        let meant = answer.firm_id.is_none_or(|firm| firm == offer.firm_id);
        meant && offer.state == OfferState::Proposed
    });
    let wrong = |why: &str| Err(Error::WrongState(why.to_owned()));
    let Some(offer) = proposed.next() else {
        return wrong("there is no proposal to answer");
    };
    if proposed.next().is_some() {
        return Err(Error::Invalid {
            field: "firm_id",
            detail: "is missing: more than one firm has proposed terms".to_owned(),
        });
    }
    if offer.answer_by.is_some_and(|by| by < change.now) {
        return wrong("the proposal has lapsed");
    }
    let mut between = Between {
        terms: offer.terms.clone(),
        text: answer.text,
        ..Between::with(offer.firm())
    };
    if yes {
        let (firm, fee_eur) = (between.firm.clone(), offer.fee());
        if let Some(terms) = &mut between.terms {
            // What a firm says nothing of is as it was offered.
            terms.fee_eur = fee_eur;
            let at = terms.planned_at;
            must_be_ahead(change, at)?;
            must_have_room(change, &firm, at, Told::Operator).await?;
            if at != change.whole.summary.planned_at {
                port_call_check::must_be_there(change, at, "planned_at").await?;
                at_its_call(change, at).await?;
            }
        }
        return change.append(Content::ProposalAccepted(between)).await;
    }
    change.append(Content::ProposalDeclined(between)).await?;
    ask_next(change).await
}
