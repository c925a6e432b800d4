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
    /// No adjustment is on record, and nothing else is due before one can be arranged.
    Unknown,
    /// Due soon.
    Soon,
    /// Due very soon, or the card cannot be trusted.
    Urgent,
    /// The due date has passed.
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
    let leading = leading(&causes, terms, today)?;
    Some(Due {
        on: leading.due,
        urgency: find_urgency(leading, terms, today),
        reason: leading.reason.clone(),
        causes,
    })
}

/// Returns the cause that a need is judged by: the earliest. A missing record, whose day is one to
/// arrange an adjustment by, hides nothing whose term runs already.
fn leading<'a>(causes: &'a [Cause], terms: &Terms, today: NaiveDate) -> Option<&'a Cause> {
    let days = terms.after_event_days.max(terms.over_limit_days);
    let last = today.checked_add_days(Days::new(days.into()));
    let runs = |cause: &&Cause| {
        cause.kind != CauseKind::NeverAdjusted && last.is_none_or(|last| cause.due <= last)
    };
    causes.iter().find(runs).or(causes.first())
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
/// be due soon. Without an adjustment on record, no interval is known to have ended.
fn find_urgency(first: &Cause, terms: &Terms, today: NaiveDate) -> Urgency {
    if first.kind == CauseKind::NeverAdjusted {
        return Urgency::Unknown;
    }
    let distrusted = matches!(
        first.kind,
        CauseKind::OverLimit | CauseKind::Change | CauseKind::FailedVerification
    );
    match terms.urgency(first.due, today) {
        Urgency::Soon if distrusted => Urgency::Urgent,
        by_date => by_date,
    }
}
