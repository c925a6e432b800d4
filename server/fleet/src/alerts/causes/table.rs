//! Rows of all causes, and access to the row of one.

use super::row::{CardEffect, CauseRow, PlanEffect};
use super::{
    adjustments, agent_link, agent_reports, deviation_over_limit, disturbances, instruments,
    model_quality, ship_changes,
};
use crate::alerts::cause::Cause;

/// All causes of alerts.
pub(in crate::alerts) static CAUSES: [CauseRow; 19] = [
    deviation_over_limit::DEVIATION_OVER_LIMIT,
    instruments::REFERENCE_FAULT,
    instruments::COMPASS_FAULT,
    ship_changes::LIGHTNING_OR_SHOCK,
    ship_changes::MAGNETIC_CARGO,
    ship_changes::DRIFT,
    ship_changes::ALIGNMENT,
    ship_changes::UNKNOWN_CHANGE,
    disturbances::LOCAL_ANOMALY,
    disturbances::MAGNETIC_STORM,
    disturbances::BERTH_STEEL,
    disturbances::GNSS_INTERFERENCE,
    model_quality::NO_MODEL,
    model_quality::WIDE_BAND,
    adjustments::ADJUSTMENT_NOT_CONFIRMED,
    adjustments::AGREED_JOB_AT_RISK,
    agent_reports::REPORTED_BY_AGENT,
    agent_link::SILENT_AGENT,
    agent_link::CLONED_AGENT,
];

impl Cause {
    /// Returns the row of the cause.
    pub(in crate::alerts) fn row(self) -> &'static CauseRow {
        let row = CAUSES.iter().find(|row| row.cause == self);
        row.expect("a test finds a row for every cause")
    }

    /// Returns the cause in a few words.
    pub fn title(self) -> &'static str {
        self.row().title
    }

    /// Returns the effect of an open alert on the deviation card.
    pub fn effect_on_card(self) -> CardEffect {
        self.row().on_card
    }

    /// Returns the effect of an open alert on a corrector plan.
    pub fn effect_on_plan(self) -> PlanEffect {
        self.row().on_plan
    }
}
