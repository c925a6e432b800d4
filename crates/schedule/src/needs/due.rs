//! The due date of a compass, with its urgency.

use super::causes::{self, Cause, CauseKind};
use super::facts::{Compass, Ship, Terms};
use crate::rules::Rule;
use chrono::{Days, NaiveDate};
use serde::{Deserialize, Serialize};

/// Urgency of a need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Urgency {
    /// Not due soon.
    Routine,
    /// Due soon.
    Soon,
    /// Due very soon, or the card cannot be trusted.
    Urgent,
    /// The due date has passed, or there never was an adjustment.
    Overdue,
}

/// A due date, with its causes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Due {
    /// The last day on which the compass may be adjusted.
    pub on: NaiveDate,
    /// Urgency.
    pub urgency: Urgency,
    /// Reason as text.
    pub reason: String,
    /// All causes, the earliest first.
    pub causes: Vec<Cause>,
}

/// Returns the due date of a compass by the rules that apply to its ship and by
/// its facts; `None` when no rule applies and nothing is wrong.
pub fn due(
    ship: &Ship,
    compass: &Compass,
    rules: &[Rule],
    terms: &Terms,
    today: NaiveDate,
) -> Option<Due> {
    let mut causes = causes::find_causes(ship, compass, rules, terms, today);
    // Among causes of one day, the first named gives the reason.
    causes.sort_by_key(|cause| cause.due);
    let first = causes.first()?;
    Some(Due {
        on: first.due,
        urgency: find_urgency(&causes, terms, today),
        reason: describe_reason(first, &causes),
        causes,
    })
}

/// Returns the first cause's reason. A missing adjustment comes before every other
/// cause, so a deviation over its limit is added to it.
fn describe_reason(first: &Cause, causes: &[Cause]) -> String {
    let over = causes
        .iter()
        .find(|cause| cause.kind == CauseKind::OverLimit);
    match over {
        Some(over) if first.kind == CauseKind::NeverAdjusted => {
            format!("{}; {}", first.reason, over.reason)
        }
        _ => first.reason.clone(),
    }
}

impl Terms {
    /// Returns the urgency of a due date, by the date alone.
    pub fn urgency(&self, due: NaiveDate, today: NaiveDate) -> Urgency {
        let within = |days: u32| {
            today
                .checked_add_days(Days::new(days.into()))
                .is_none_or(|last| due <= last)
        };
        if due < today {
            Urgency::Overdue
        } else if within(self.urgent_days) {
            Urgency::Urgent
        } else if within(self.soon_days) {
            Urgency::Soon
        } else {
            Urgency::Routine
        }
    }
}

/// Returns the urgency of a need. An untrustworthy card makes it urgent when it would
/// be due soon. A compass without an adjustment on record is due today on every day: it is overdue.
fn find_urgency(causes: &[Cause], terms: &Terms, today: NaiveDate) -> Urgency {
    let never = |cause: &Cause| cause.kind == CauseKind::NeverAdjusted;
    let first = match causes.first() {
        Some(first) if !causes.iter().any(never) => first,
        _ => return Urgency::Overdue,
    };
    let distrusted = matches!(
        first.kind,
        CauseKind::OverLimit | CauseKind::Change | CauseKind::FailedVerification
    );
    match terms.urgency(first.due, today) {
        Urgency::Soon if distrusted => Urgency::Urgent,
        by_date => by_date,
    }
}
