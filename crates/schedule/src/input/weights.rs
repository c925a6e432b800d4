//! Cost weights of the schedule: the operator's own figures, in euros.

use crate::needs::Urgency;
use crate::time::Eur;
use serde::{Deserialize, Serialize};

/// Default hours of a job on board.
pub const JOB_H: f64 = 3.0;

/// A weight for each urgency.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ByUrgency {
    /// For routine needs.
    pub routine: Eur,
    /// For needs due soon, or on a day that is unknown.
    pub soon: Eur,
    /// For urgent needs.
    pub urgent: Eur,
    /// For overdue needs.
    pub overdue: Eur,
}

/// Cost weights of the schedule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Weights {
    /// Cost of an unmet need, in addition to waiting until the end of the
    /// horizon. A late one costs this too, unless `late_days` is set.
    pub unmet_eur: ByUrgency,
    /// Cost of a job that misses its ship, in addition to waiting for the next
    /// call.
    pub missed_eur: ByUrgency,
    /// Cost of each day that a need waits.
    pub waiting_eur_day: ByUrgency,
    /// Cost of each day to come after the due date.
    pub late_eur_day: Eur,
    /// Cost of each day of the interval lost by adjusting before the due date.
    pub early_eur_day: Eur,
    /// Cost of another firm, call or day than was proposed.
    pub changed_eur: Eur,
    /// Cost of another than was offered.
    pub withdrawn_eur: Eur,
    /// Days after the due date on which a job may still be planned, even if it
    /// could be done in time at more cost. Without it, a job is planned late
    /// only if it cannot be done in time. An overdue job may be planned on any
    /// day.
    pub late_days: Option<u32>,
    /// Hours of a job on board.
    pub job_h: f64,
    /// Days within which a ship's needs, counted from the first due date, form
    /// one job.
    pub join_days: u32,
}

impl ByUrgency {
    /// Returns the weight of an urgency.
    pub fn weight(&self, urgency: Urgency) -> Eur {
        match urgency {
            Urgency::Routine => self.routine,
            // Its interval may end on any day.
            Urgency::Unknown | Urgency::Soon => self.soon,
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
