//! Adjustments that headings at sea contradict, or that no longer fit the schedule.

use super::facts::{JobAtRisk, UnconfirmedAdjustment};
use super::row::{CardEffect, CauseRow, Condition, Ending, Finder, PlanEffect};
use crate::alerts::cause::Cause;
use crate::alerts::desired::EventWindow;
use binnacle_platform::severity::Severity;

/// Failed verification, as long as the work order is in that state.
pub(super) const ADJUSTMENT_NOT_CONFIRMED: CauseRow = CauseRow {
    cause: Cause::AdjustmentNotConfirmed,
    title: "adjustment not confirmed at sea",
    finders: &[Finder::Verification(not_confirmed)],
    severity: |_| Severity::Critical,
    advice: |_| {
        "Do not use the predicted card. Take azimuths on all headings, check that the correctors \
         stand as recorded, and have the ship swung or adjusted again."
    },
    on_card: CardEffect::Note,
    on_plan: PlanEffect::Note,
    ending: Ending::NotFound,
    ends_with_adjustment: true,
    is_redated: false,
};

/// Agreed job that no longer fits: an ETA after the due date, a cancelled port call, fewer teams.
pub(super) const AGREED_JOB_AT_RISK: CauseRow = CauseRow {
    cause: Cause::AgreedJobAtRisk,
    title: "agreed adjustment no longer fits",
    finders: &[Finder::Schedule(at_risk)],
    severity: |_| Severity::Warning,
    advice: |_| {
        "Agree on another time with the firm, or cancel its order and offer the job as it is \
         scheduled now."
    },
    on_card: CardEffect::None,
    on_plan: PlanEffect::None,
    ending: Ending::NotFound,
    ends_with_adjustment: false,
    is_redated: false,
};

fn not_confirmed(adjustment: &UnconfirmedAdjustment) -> Condition {
    let at = adjustment.adjusted_at;
    Condition {
        window: EventWindow::exactly(at),
        evidence: vec![format!(
            "Work order {}, adjusted at {}; {} samples since.",
            adjustment.order,
            at.to_the_minute(),
            adjustment.samples
        )],
        ..Condition::new(
            at,
            format!(
                "Headings at sea do not agree with the prediction of the adjustment: {}.",
                adjustment.verdict
            ),
        )
    }
}

fn at_risk(job: &JobAtRisk) -> Condition {
    let orders = job.orders.iter();
    Condition {
        evidence: orders.map(|order| format!("Work order {order}.")).collect(),
        ..Condition::new(
            job.since,
            format!(
                "The adjustment agreed with {} for {} no longer fits: {}.",
                job.firm, job.day, job.reason
            ),
        )
    }
}
