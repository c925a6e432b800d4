//! A need as the API shows it.

use super::facts::Facts;
use super::order::OpenOrder;
use super::prediction::PredictedDeviation;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_schedule::needs::{CauseKind, Due, Terms, Urgency, due};
use binnacle_schedule::rules::{Provenance, Rule, built_in_rules};
use chrono::{Datelike, NaiveDate};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// Next adjustment of a compass: due date and causes.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = AdjustmentNeed)]
pub struct Need {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Name of the vessel.
    pub vessel_name: String,
    /// The compass.
    pub compass_id: CompassId,
    /// Name of the compass.
    pub compass_name: String,
    /// Last day for the adjustment.
    pub due_on: NaiveDate,
    /// Urgency of the due date.
    pub urgency: Urgency,
    /// Reason of the due date, as a sentence.
    #[schema(example = "24 months after the adjustment of 2025-01-15 (ISO 25862:2019, Annex G)")]
    pub reason: String,
    /// All causes, the earliest first.
    pub causes: Vec<Cause>,
    /// Day of the last adjustment on record.
    #[schema(required)]
    pub adjusted_on: Option<NaiveDate>,
    /// Greatest deviation predicted for each place and day to come, where the model's band is
    /// narrow enough.
    pub predicted: Vec<PredictedDeviation>,
    /// Work order of the compass that is not over: what is under way, or waits for somebody.
    #[schema(required)]
    pub order: Option<OpenOrder>,
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
    /// Due date by this cause.
    pub due_on: NaiveDate,
    /// Reason, as a sentence.
    pub reason: String,
    /// The rule, if the cause is one.
    #[schema(required)]
    pub rule: Option<RuleCited>,
}

/// Citation of a rule.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct RuleCited {
    /// Stable name of the rule.
    #[schema(example = "iso-25862-interval")]
    pub id: String,
    /// Issuer and name of the document.
    pub document: String,
    /// Section of the document.
    #[schema(required)]
    pub section: Option<String>,
    /// True when the rule was read in a copy or a report, not in the document itself.
    pub second_hand: bool,
}

/// A page of needs.
#[derive(Serialize, ToSchema)]
#[schema(as = AdjustmentNeedList)]
pub(super) struct NeedList {
    /// Needs, the first due first.
    pub(super) items: Vec<Need>,
    /// `after` of the next page.
    #[schema(required)]
    pub(super) next: Option<String>,
}

/// Filter of a list of needs.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Filter {
    /// Only needs of this urgency.
    pub(super) urgency: Option<Urgency>,
    /// Only needs due on this day or before.
    pub(super) due_by: Option<NaiveDate>,
}

/// Returns the need of a compass; `None` when no rule binds its ship and nothing is wrong.
pub fn find_need(facts: &Facts, terms: &Terms, today: NaiveDate) -> Option<Need> {
    let due = due(&facts.ship, &facts.compass, built_in_rules(), terms, today)?;
    Some(Need::new(facts, due))
}

impl Need {
    /// Builds the need from facts and due date.
    fn new(facts: &Facts, due: Due) -> Need {
        let causes = due.causes.into_iter().map(|cause| Cause {
            kind: cause.kind,
            due_on: cause.due,
            reason: cause.reason,
            rule: cause.rule.as_deref().and_then(find_citation),
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
            predicted: facts.predicted.clone(),
            order: facts.order.clone(),
            not_known: facts.unknown_particulars(),
        }
    }

    /// Returns the cursor of the page after this need.
    pub(super) fn cursor(&self) -> String {
        format!("{}.{}", day_number(self.due_on), self.compass_id)
    }
}

fn find_citation(id: &str) -> Option<RuleCited> {
    let rule: &Rule = built_in_rules().iter().find(|rule| rule.id == id)?;
    Some(RuleCited {
        id: rule.id.clone(),
        document: rule.citation.document.clone(),
        section: rule.citation.section.clone(),
        second_hand: rule.citation.read == Provenance::SecondHand,
    })
}

/// Returns the number of a day, for cursors.
pub(super) fn day_number(day: NaiveDate) -> i64 {
    i64::from(day.num_days_from_ce())
}
