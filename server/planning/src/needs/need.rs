//! A need, as it is shown.

use super::prediction::Ahead;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_schedule::needs::{CauseKind, Due, Urgency};
use binnacle_schedule::rules::{Rule, built_in_rules};
use chrono::NaiveDate;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// A compass, and when and why it is to be adjusted next.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = AdjustmentNeed)]
pub struct Need {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Her name.
    pub vessel_name: String,
    /// The compass.
    pub compass_id: CompassId,
    /// Its name.
    pub compass_name: String,
    /// The last day on which it may be adjusted.
    pub due_on: NaiveDate,
    /// Urgency of the due date.
    pub urgency: Urgency,
    /// Reason in plain words.
    #[schema(
        example = "24 months after the adjustment of 2025-01-15 (ISO 25862:2019, Annex G, \
                        read second-hand)"
    )]
    pub reason: String,
    /// All causes, the earliest first.
    pub causes: Vec<Cause>,
    /// The day of the last adjustment on record.
    #[schema(required)]
    pub adjusted_on: Option<NaiveDate>,
    /// The greatest deviation predicted for the places and days ahead, where the model is
    /// sure enough to tell.
    pub predicted: Vec<Ahead>,
    /// Particulars of the vessel that are unknown; a rule that depends on one binds the vessel.
    #[schema(example = json!(["gross_tonnage"]))]
    pub not_known: Vec<&'static str>,
}

/// One cause, with its own due date.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = NeedCause)]
pub struct Cause {
    /// Kind of cause.
    pub kind: CauseKind,
    /// By when it wants the compass adjusted.
    pub due_on: NaiveDate,
    /// In words.
    pub reason: String,
    /// The rule, where it is one.
    #[schema(required)]
    pub rule: Option<RuleCited>,
}

/// A rule, and where it is written.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct RuleCited {
    /// Its name here, which stays when its words change.
    #[schema(example = "iso-25862-interval")]
    pub id: String,
    /// Issuer and name of the document.
    pub document: String,
    /// Section of the document.
    #[schema(required)]
    pub section: Option<String>,
    /// Whether the rule was read in a copy or a report rather than in the document itself.
    pub second_hand: bool,
}

/// A page of needs.
#[derive(Serialize, ToSchema)]
#[schema(as = AdjustmentNeedList)]
pub(super) struct NeedList {
    /// The first due first.
    pub(super) items: Vec<Need>,
    /// `after` of the next page.
    #[schema(required)]
    pub(super) next: Option<String>,
}

/// Filter of a list of needs.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Filter {
    /// Of this urgency only.
    pub(super) urgency: Option<Urgency>,
    /// Due on this day or before.
    pub(super) due_by: Option<NaiveDate>,
}

impl Need {
    /// Puts a need together.
    pub(super) fn new(facts: &super::facts::Facts, due: Due) -> Need {
        let causes = due.causes.into_iter().map(|cause| Cause {
            kind: cause.kind,
            due_on: cause.due,
            reason: cause.reason,
            rule: cause.rule.as_deref().and_then(cited),
        });
        Need {
            vessel_id: facts.vessel_id,
            vessel_name: facts.vessel_name.clone(),
            compass_id: facts.compass_id,
            compass_name: facts.compass_name.clone(),
            due_on: due.on,
            urgency: due.urgency,
            reason: due.reason,
            causes: causes.collect(),
            adjusted_on: facts.compass.adjusted_on,
            predicted: facts.ahead.clone(),
            not_known: facts.not_known(),
        }
    }

    /// `after` of a page that begins behind it.
    pub(super) fn cursor(&self) -> String {
        format!("{}.{}", super::day_number(self.due_on), self.compass_id)
    }
}

fn cited(id: &str) -> Option<RuleCited> {
    let rule: &Rule = built_in_rules().iter().find(|rule| rule.id == id)?;
    Some(RuleCited {
        id: rule.id.clone(),
        document: rule.citation.document.clone(),
        section: rule.citation.section.clone(),
        second_hand: rule.citation.read == binnacle_schedule::rules::Read::SecondHand,
    })
}
