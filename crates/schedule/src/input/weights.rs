//! What counts how much: the operator's own figures, in euros.

use crate::needs::Urgency;
use crate::time::Eur;
use serde::{Deserialize, Serialize};

/// Hours that a job takes on board where nobody says otherwise.
pub const JOB_H: f64 = 3.0;

/// A figure for each urgency.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ByUrgency {
    /// For routine needs.
    pub routine: Eur,
    /// For what is due soon.
    pub soon: Eur,
    /// For what is urgent.
    pub urgent: Eur,
    /// For what is overdue.
    pub overdue: Eur,
}

/// What counts how much.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Weights {
    /// A need that is not met, beside all the waiting to the end of the horizon;
    /// and one that is met late, where nobody has said how late it may be.
    pub unmet_eur: ByUrgency,
    /// A job at which the ship turns out not to be there, beside waiting for the next.
    pub missed_eur: ByUrgency,
    /// Each day that a need waits.
    pub waiting_eur_day: ByUrgency,
    /// Each day after the due date that is still to come.
    pub late_eur_day: Eur,
    /// Each day of an interval that is given away by adjusting before the due date.
    pub early_eur_day: Eur,
    /// Another firm, call or day than was proposed.
    pub changed_eur: Eur,
    /// Another than was offered.
    pub withdrawn_eur: Eur,
    /// Days after the due date on which a job may be planned, and no later, though it could
    /// be done in time at more cost. Where it is not said, a job is planned late only where
    /// it is that or not at all. What is overdue may be planned on any day.
    pub late_days: Option<u32>,
    /// Hours that a job takes on board.
    pub job_h: f64,
    /// Needs of one ship that are due within so many days of the first are one job.
    pub join_days: u32,
}

impl ByUrgency {
    /// The figure for an urgency.
    pub fn of(&self, urgency: Urgency) -> Eur {
        match urgency {
            Urgency::Routine => self.routine,
            Urgency::Soon => self.soon,
            Urgency::Urgent => self.urgent,
            Urgency::Overdue => self.overdue,
        }
    }
}

impl Default for Weights {
    fn default() -> Weights {
        let by = |routine, soon, urgent, overdue| ByUrgency {
            routine: Eur::whole(routine),
            soon: Eur::whole(soon),
            urgent: Eur::whole(urgent),
            overdue: Eur::whole(overdue),
        };
        Weights {
            unmet_eur: by(20_000, 30_000, 45_000, 60_000),
            missed_eur: by(1_000, 2_500, 6_000, 9_000),
            waiting_eur_day: by(0, 0, 60, 150),
            late_eur_day: Eur::whole(500),
            early_eur_day: Eur::whole(3),
            changed_eur: Eur::whole(150),
            withdrawn_eur: Eur::whole(500),
            late_days: None,
            job_h: JOB_H,
            join_days: 90,
        }
    }
}
