//! Columns of the table of causes.

use super::facts::{
    AgentReports, DetectedChange, Facts, Silence, Situation, StreamConflict, UnconfirmedAdjustment,
};
use super::facts::{JobAtRisk, Stage};
use crate::alerts::alert::Evidence;
use crate::alerts::cause::Cause;
use crate::alerts::desired::{DesiredAlert, EventWindow};
use crate::analysis::Findings;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;
use binnacle_wire::alert::Suspect;

/// A row of the table: all that is particular to one cause.
pub(in crate::alerts) struct CauseRow {
    /// The cause.
    pub cause: Cause,
    /// The cause in a few words.
    pub title: &'static str,
    /// Predicates that find it; the first match counts. All are of one source.
    pub finders: &'static [Finder],
    /// Rule for its severity.
    pub severity: fn(&Size) -> Severity,
    /// Advice to the crew and the office.
    pub advice: fn(Case) -> &'static str,
    /// Effect of an open alert on the deviation card.
    pub on_card: CardEffect,
    /// Effect of an open alert on a corrector plan.
    pub on_plan: PlanEffect,
    /// Rule by which it clears itself.
    pub ending: Ending,
    /// True if an adjustment ends it that came after its beginning.
    pub ends_with_adjustment: bool,
    /// True if later samples change its date: it is an event rather than a state.
    pub is_redated: bool,
}

/// A predicate, and by its kind the part of the system that evaluates it.
pub(in crate::alerts) enum Finder {
    /// An analysis, of a change that its detector found.
    Change(fn(&DetectedChange<'_>) -> Option<Condition>),
    /// An analysis, of all its findings.
    Findings(fn(&Situation<'_>) -> Option<Condition>),
    /// An analysis, of the verification of the last adjustment.
    Verification(fn(&UnconfirmedAdjustment) -> Condition),
    /// A batch, by the alerts of the ship's agent in it.
    AgentReports(fn(&AgentReports<'_>) -> Option<Condition>),
    /// A batch, by its stream.
    Batch(fn(&StreamConflict) -> Condition),
    /// The clock.
    Clock(fn(&Silence<'_>) -> Option<Condition>),
    /// A schedule.
    Schedule(fn(&JobAtRisk) -> Condition),
}

/// The part of the system that raises and clears alerts of a cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::alerts) enum Source {
    /// An analysis, in the transaction that stores it.
    Analysis,
    /// The ship's agent, in the transaction that stores its batch.
    Agent,
    /// The server's view of a batch, in the transaction that stores it.
    Batch,
    /// The clock.
    Clock,
    /// A schedule, in the transaction that stores it.
    Schedule,
}

/// Effect of an open alert on the deviation card of its compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CardEffect {
    /// No effect.
    None,
    /// The card carries the alert's summary as a note.
    Note,
    /// The card is refused.
    Block,
}

/// Effect of an open alert on a corrector plan for its compass. No alert blocks a plan: an
/// adjustment is the cure of many, and the adjuster decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanEffect {
    /// No effect.
    None,
    /// The plan carries the alert's summary as a note.
    Note,
}

/// Rule by which an alert clears itself.
#[derive(Clone, Copy)]
pub(in crate::alerts) enum Ending {
    /// Its source no longer finds it.
    NotFound,
    /// Its source no longer finds it. Without the figure, its end is unknown.
    NotMeasured(fn(&Findings) -> bool),
    /// The change that it is about is over, withdrawn, learned by the model, or renamed.
    WithChange,
    /// Nothing has shown it for a time.
    AfterSilence {
        /// Seconds.
        seconds: f64,
    },
}

/// A cause that holds, before the row adds severity and advice.
pub(in crate::alerts) struct Condition {
    /// Beginning of the cause.
    pub since: Time,
    /// Dates of a stored alert about the same event.
    pub window: EventWindow,
    /// Figures for the severity.
    pub size: Size,
    /// Case for the advice.
    pub case: Case,
    /// The facts, in a sentence.
    pub summary: String,
    /// The evidence, a sentence each.
    pub evidence: Vec<String>,
}

/// Figures from which a severity follows.
#[derive(Clone, Copy)]
pub(in crate::alerts) struct Size {
    /// The size, degrees.
    pub magnitude_deg: f64,
    /// The lower end of its 95 % band, degrees.
    pub at_least_deg: f64,
    /// The vessel's limit on the deviation, degrees.
    pub limit_deg: f64,
    /// The severity of the open alert.
    pub was: Option<Severity>,
    /// The greatest severity that the state of knowledge allows.
    pub ceiling: Severity,
}

/// Case of a cause, where the advice differs by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::alerts) enum Case {
    /// The only one.
    Only,
    /// A change, by the state of the model after it.
    Change(Stage),
    /// A reference's fault that may as well be the compass's.
    CompassOrReference,
    /// A reference's fault, not yet confirmed, that may as well be a change of the ship.
    ShipOrReference,
    /// Compass and reference have parted.
    Parted {
        /// The instrument that the two others contradict.
        suspect: Suspect,
        /// True if the gyro is one of them.
        has_gyro: bool,
    },
    /// Compass and reference have not parted since.
    Agreeing,
    /// No card judges the compass any more.
    NotJudged,
    /// The receivers of satellites are disturbed.
    Interference,
}

impl CauseRow {
    /// Returns the source of its alerts.
    pub(in crate::alerts) fn source(&self) -> Source {
        match self.finders.first() {
            Some(Finder::AgentReports(_)) => Source::Agent,
            Some(Finder::Batch(_)) => Source::Batch,
            Some(Finder::Clock(_)) => Source::Clock,
            Some(Finder::Schedule(_)) => Source::Schedule,
            Some(Finder::Change(_) | Finder::Findings(_) | Finder::Verification(_)) | None => {
                Source::Analysis
            }
        }
    }

    /// Returns the alert that the facts call for.
    pub(in crate::alerts) fn find(&self, facts: &Facts<'_>) -> Option<DesiredAlert> {
        let condition = self.finders.iter().find_map(|finder| finder.find(facts))?;
        Some(DesiredAlert {
            cause: self.cause,
            severity: (self.severity)(&condition.size),
            since: condition.since,
            window: condition.window,
            summary: condition.summary,
            advice: (self.advice)(condition.case),
            evidence: Evidence(condition.evidence),
        })
    }
}

impl Finder {
    fn find(&self, facts: &Facts<'_>) -> Option<Condition> {
        match (self, facts) {
            (Finder::Change(find), Facts::Change(change)) => find(change),
            (Finder::Findings(find), Facts::Findings(situation)) => find(situation),
            (Finder::Verification(find), Facts::Verification(adjustment)) => Some(find(adjustment)),
            (Finder::AgentReports(find), Facts::AgentReports(reports)) => find(reports),
            (Finder::Batch(find), Facts::Batch(conflict)) => Some(find(conflict)),
            (Finder::Clock(find), Facts::Clock(silence)) => find(silence),
            (Finder::Schedule(find), Facts::Schedule(job)) => Some(find(job)),
            _ => None,
        }
    }
}

impl Condition {
    /// Makes a lasting condition, of a cause with one severity and one case.
    pub(super) fn new(since: Time, summary: String) -> Condition {
        Condition {
            since,
            window: EventWindow::default(),
            size: Size::default(),
            case: Case::Only,
            summary,
            evidence: Vec::new(),
        }
    }
}

impl Default for Size {
    fn default() -> Size {
        Size {
            magnitude_deg: 0.0,
            at_least_deg: 0.0,
            limit_deg: 0.0,
            was: None,
            ceiling: Severity::Critical,
        }
    }
}
