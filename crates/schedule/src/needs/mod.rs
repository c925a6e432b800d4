//! When a compass must be adjusted next, how urgent that is, and why.
//!
//! What always holds: a due date is the earliest of its causes, each cause says in
//! words what makes it and, where it is a rule, which; the same facts on the same day
//! give the same need.

mod causes;

use crate::rules::{Canal, DeviationRecord, EventKind, Flag, Limit, Rule, Trade};
use crate::time::Instant;
use chrono::{Days, NaiveDate};
use serde::{Deserialize, Serialize};

/// What is known of a ship that rules ask about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ship {
    /// Her flag; every flag's rules bind her when it is not known.
    #[serde(default)]
    pub flag: Option<Flag>,
    /// Her gross tonnage; a rule for large ships binds her when it is not known.
    #[serde(default)]
    pub gross_tonnage: Option<u32>,
    /// Her trade; a rule for some trades binds her when it is not known.
    #[serde(default)]
    pub trade: Option<Trade>,
    /// Whether the deviation book is kept; when it is not known, it is not kept.
    #[serde(default)]
    pub deviation_record: Option<DeviationRecord>,
    /// Transits that are planned.
    #[serde(default)]
    pub transits: Vec<Transit>,
}

/// A planned transit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Transit {
    /// Through which canal.
    pub canal: Canal,
    /// On which day.
    pub on: NaiveDate,
}

/// What is known of one compass.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compass {
    /// The day of the last adjustment; none where none is on record.
    #[serde(default)]
    pub adjusted_on: Option<NaiveDate>,
    /// The instant of the last adjustment, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adjusted_at: Option<Instant>,
    /// What befell ship and compass; what came before the last adjustment is over.
    #[serde(default)]
    pub events: Vec<Event>,
    /// The worst deviation on any heading, as the model predicts it, day by day; of a day
    /// that is past, what it has been at least since.
    #[serde(default)]
    pub predicted: Vec<Predicted>,
    /// The greatest deviation on any heading that the ship's operator lets stand, degrees;
    /// none where none is said.
    #[serde(default)]
    pub deviation_limit_deg: Option<Limit>,
    /// A change of the ship's magnetism that was found.
    #[serde(default)]
    pub change: Option<Change>,
    /// A verification at sea that the last adjustment did not pass.
    #[serde(default)]
    pub failed_verification: Option<FailedVerification>,
    /// Whether headings at sea have yet to say whether the last adjustment holds.
    #[serde(default)]
    pub awaits_verification: bool,
}

/// An event.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// What happened.
    pub kind: EventKind,
    /// When, or when it is to end.
    pub on: NaiveDate,
    /// The instant of that, where it is known: what came after an adjustment of the same day
    /// is told from what came before it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<Instant>,
}

/// A prediction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Predicted {
    /// For which day.
    pub on: NaiveDate,
    /// For where, as it stands behind "at"; none where that is not said.
    #[serde(default)]
    pub place: Option<String>,
    /// The largest deviation on any heading, either way.
    pub worst_deviation_deg: f64,
    /// Which way that is; none where it is not said.
    #[serde(default)]
    pub side: Option<Side>,
}

/// Which way a compass deviates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Its north lies east of magnetic north.
    East,
    /// Its north lies west of magnetic north.
    West,
}

impl Side {
    /// The side of a deviation, degrees, east positive.
    pub fn of(deviation_deg: f64) -> Side {
        if deviation_deg < 0.0 {
            Side::West
        } else {
            Side::East
        }
    }
}

/// A change of magnetism.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Since when.
    pub on: NaiveDate,
    /// By how much it changes the deviation on the worst heading.
    pub size_deg: f64,
}

/// A verification that failed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FailedVerification {
    /// When.
    pub on: NaiveDate,
    /// By how much headings at sea were off what the card says, on the worst heading.
    pub worst_error_deg: f64,
}

/// The product's own terms, where a rule says "must" and no date.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Terms {
    /// Days from an event, a change or a failed verification to the due date.
    pub after_event_days: u32,
    /// Days from the day on which deviation goes over its limit.
    pub over_limit_days: u32,
    /// What is due within so many days is urgent.
    pub urgent_days: u32,
    /// What is due within so many days is due soon.
    pub soon_days: u32,
    /// A change of this many hundredths of a degree, or more, counts.
    pub change_centideg: u32,
}

impl Default for Terms {
    fn default() -> Terms {
        Terms {
            after_event_days: 30,
            over_limit_days: 14,
            urgent_days: 14,
            soon_days: 60,
            change_centideg: 200,
        }
    }
}

/// How much a need presses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Urgency {
    /// There is time.
    Routine,
    /// Due soon.
    Soon,
    /// Due very soon, or the card is not to be trusted.
    Urgent,
    /// The due date has passed, or there never was an adjustment.
    Overdue,
}

/// What brings a due date about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CauseKind {
    /// No adjustment is on record.
    NeverAdjusted,
    /// A rule's interval ends.
    Interval,
    /// A rule asks for an adjustment after an event.
    Event,
    /// Predicted deviation is over a rule's limit, or the vessel's own.
    OverLimit,
    /// A transit asks for a newer table or a smaller deviation.
    Transit,
    /// The ship's magnetism changed.
    Change,
    /// The last adjustment did not pass at sea.
    FailedVerification,
}

/// One cause, with its own due date.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Cause {
    /// What it is.
    pub kind: CauseKind,
    /// By when it wants the compass adjusted.
    pub due: NaiveDate,
    /// In words.
    pub reason: String,
    /// The rule's name, where it is one.
    pub rule: Option<String>,
}

/// When a compass is due, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Due {
    /// The last day on which it may be adjusted.
    pub on: NaiveDate,
    /// How much that presses.
    pub urgency: Urgency,
    /// Why, in words.
    pub reason: String,
    /// All causes, the earliest first.
    pub causes: Vec<Cause>,
}

/// When a compass is due by the rules that bind its ship and by what is known of it;
/// nothing when no rule binds her and nothing is wrong.
pub fn due(
    ship: &Ship,
    compass: &Compass,
    rules: &[Rule],
    terms: &Terms,
    today: NaiveDate,
) -> Option<Due> {
    let mut causes = causes::find(ship, compass, rules, terms, today);
    // Of causes on one day the one named first speaks for it.
    causes.sort_by_key(|cause| cause.due);
    let first = causes.first()?;
    Some(Due {
        on: first.due,
        urgency: urgency(&causes, terms, today),
        reason: reason(first, &causes),
        causes,
    })
}

/// The first cause's. Nothing is due before what was never adjusted, so what presses beside
/// that is said with it.
fn reason(first: &Cause, causes: &[Cause]) -> String {
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
    /// How much a due date presses, when nothing but the date does.
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

/// A card that is not to be trusted makes urgent what would be due soon. A compass without
/// an adjustment on record is due today on every day: it is overdue.
fn urgency(causes: &[Cause], terms: &Terms, today: NaiveDate) -> Urgency {
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
