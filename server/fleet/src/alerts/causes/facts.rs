//! Facts that the predicates of the table read: one type for each kind of finder.

use super::hysteresis::SLACK_DEG;
use crate::alerts::alert::KnownAlert;
use crate::alerts::cause::Cause;
use crate::analysis::{ChangeFinding, Findings};
use crate::settings::AlertLimits;
use binnacle_compass::time::Timestamp;
use binnacle_platform::ids::OrderId;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;
use binnacle_wire::alert::ShipAlert;
use chrono::NaiveDate;
use uuid::Uuid;

/// Facts of any kind.
#[derive(Clone, Copy)]
pub(in crate::alerts) enum Facts<'a> {
    /// A change that the detector found.
    Change(&'a DetectedChange<'a>),
    /// Findings of an analysis.
    Findings(&'a Situation<'a>),
    /// An adjustment that headings at sea contradict.
    Verification(&'a UnconfirmedAdjustment),
    /// Alerts of the ship's agent.
    AgentReports(&'a AgentReports<'a>),
    /// A batch in an older stream.
    Batch(&'a StreamConflict),
    /// Time since the last upload.
    Clock(&'a Silence<'a>),
    /// An agreed job that no longer fits.
    Schedule(&'a JobAtRisk),
}

/// Cause and severity of an open alert.
#[derive(Clone, Copy, Debug)]
pub(in crate::alerts) struct OpenCause {
    /// Its cause.
    pub cause: Cause,
    /// Its severity.
    pub severity: Severity,
}

/// Findings of an analysis, with the vessel's limits and the alerts that are open.
#[derive(Clone, Copy)]
pub(in crate::alerts) struct Situation<'a> {
    /// The findings.
    pub findings: &'a Findings,
    /// The vessel's limits.
    pub limits: &'a AlertLimits,
    /// The open alerts' causes and severities.
    pub open: &'a [OpenCause],
    /// Time of the last sample.
    pub data_until: Timestamp,
    /// True if the changes call for an alert other than a reference's fault.
    pub has_change: bool,
}

/// A change that the detector found, among the findings of its analysis.
#[derive(Clone, Copy)]
pub(in crate::alerts) struct DetectedChange<'a> {
    /// The change.
    pub found: &'a ChangeFinding,
    /// All findings.
    pub findings: &'a Findings,
    /// The vessel's limits.
    pub limits: &'a AlertLimits,
    /// The severity of the open alert of its cause.
    pub was: Option<Severity>,
}

/// State of the ship's model after a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::alerts) enum Stage {
    /// The change is not certain.
    Unconfirmed,
    /// No card holds.
    NoModel,
    /// The model since covers less than a day, or is less certain than the limit requires.
    Interim,
    /// The model since is as certain as the limit requires.
    Learned,
    /// The change is not of the ship's magnetism.
    NotTheShips,
}

/// An adjustment that headings at sea contradict.
#[derive(Clone, Debug)]
pub struct UnconfirmedAdjustment {
    /// The work order.
    pub order: OrderId,
    /// Time of the adjustment.
    pub adjusted_at: Time,
    /// The verdict in words.
    pub verdict: String,
    /// Number of samples that it rests on.
    pub samples: usize,
}

/// Alerts of the ship's agent, and the stored alert about them.
#[derive(Clone, Copy)]
pub(in crate::alerts) struct AgentReports<'a> {
    /// The agent's alerts, the latest first.
    pub reports: &'a [ShipAlert],
    /// The stored alert.
    pub known: Option<&'a KnownAlert>,
    /// Time until which the ship's samples, or the clock, tell.
    pub until: Option<Timestamp>,
}

/// A new batch in a stream, although its agent has sent in a newer one.
#[derive(Clone, Copy, Debug)]
pub(in crate::alerts) struct StreamConflict {
    /// The older stream.
    pub stream: Uuid,
    /// Number of the batch in it.
    pub seq: u64,
    /// The newer stream.
    pub newer: Uuid,
    /// Time at which the newer stream was opened.
    pub newer_opened_at: Time,
}

/// Time since a compass's agents were last heard.
#[derive(Clone, Copy)]
pub(in crate::alerts) struct Silence<'a> {
    /// Time of the last upload.
    pub last_upload: Time,
    /// The vessel's limits.
    pub limits: &'a AlertLimits,
    /// The present time.
    pub now: Time,
}

/// An adjustment agreed with a firm that no longer fits the schedule.
#[derive(Clone, Debug)]
pub struct JobAtRisk {
    /// Time of the schedule that found it.
    pub since: Time,
    /// The firm's name.
    pub firm: String,
    /// The agreed day.
    pub day: NaiveDate,
    /// The reason, as part of a sentence.
    pub reason: String,
    /// The job's work orders.
    pub orders: Vec<OrderId>,
}

impl Situation<'_> {
    /// Returns the severity of the open alert of a cause.
    pub(super) fn open_severity(&self, cause: Cause) -> Option<Severity> {
        let open = self.open.iter().find(|open| open.cause == cause);
        open.map(|open| open.severity)
    }

    /// Returns the limit that ends an open alert of a cause, or raises one.
    pub(super) fn limit_deg(&self, cause: Cause, limit_deg: f64) -> f64 {
        let slack_deg = self.open_severity(cause).map_or(0.0, |_| SLACK_DEG);
        limit_deg - slack_deg
    }
}
