//! Changes found in one epoch of the logbook.

use crate::estimate::Prior;
use binnacle_compass::result::{Cause, Change, NoiseLevels};
use binnacle_compass::time::Timestamp;

/// Greatest error of the logbook's time for work, seconds: people write down when they
/// noticed, or what was planned.
pub(crate) const MISTIMED_S: f64 = 86_400.0;

/// Findings in one epoch of the logbook.
pub(crate) struct ChangeFindings {
    pub(crate) changes: Vec<Change>,
    /// Beginnings of epochs beside the logbook's.
    pub(crate) boundaries: Vec<Boundary>,
    /// Possible end of a change, where it is open.
    pub(crate) possible_return: Option<PossibleEnd>,
    /// A possible change at a port call that was not detected.
    pub(crate) undetected_step: Option<PossibleStart>,
    /// A possible alignment change in place of the only reference's fault.
    pub(crate) possible_alignment: Option<PossibleAlignment>,
    /// Variance of bx and of by for a step that is not certain, nT².
    pub(crate) undecided_step_nt2: Option<f64>,
    /// True if changes are detected.
    pub(crate) is_watched: bool,
}

impl ChangeFindings {
    /// Returns the time of work that the logbook dates soon afterwards: people write down
    /// when they noticed.
    pub(crate) fn reported_late(&self, said: Timestamp) -> Option<Timestamp> {
        let last = self.boundaries.last().filter(|last| !last.resumes)?;
        (self.is_work(last) && said.seconds_since(last.at) < MISTIMED_S).then_some(last.at)
    }

    /// Returns the time of work that the logbook dates before.
    pub(crate) fn reported_early(&self, said: Timestamp) -> Option<Timestamp> {
        let mut later = self.boundaries.iter().filter(|boundary| boundary.at > said);
        let first = later.next().filter(|first| !first.resumes)?;
        let after_s = self.changes[first.change].from_earliest.seconds_since(said);
        let is_later = after_s > 0.0 && after_s < MISTIMED_S;
        (self.is_work(first) && is_later).then_some(first.at)
    }

    fn is_work(&self, boundary: &Boundary) -> bool {
        self.changes[boundary.change].cause == Cause::AdjustmentOrRepair
    }
}

/// A change that may have ended.
pub(crate) struct PossibleEnd {
    /// Time of the possible end.
    pub(crate) at: Timestamp,
    /// Place of the change in the list.
    pub(crate) change: usize,
    pub(crate) probability: f64,
}

/// A change that may have begun.
pub(crate) struct PossibleStart {
    pub(crate) at: Timestamp,
    pub(crate) probability: f64,
}

/// A possible alignment change, with its size in degrees and variance.
pub(crate) struct PossibleAlignment {
    pub(crate) moved_deg: f64,
    pub(crate) variance: f64,
    pub(crate) probability: f64,
}

/// Beginning of an epoch by a change.
pub(crate) struct Boundary {
    pub(crate) at: Timestamp,
    /// Place of the change in the list.
    pub(crate) change: usize,
    /// True if the change ended here and the vessel returned to its earlier state.
    pub(crate) resumes: bool,
}

/// Prior knowledge of the vessel and of its instruments' noise.
pub(crate) struct PriorKnowledge {
    pub(crate) prior: Prior,
    pub(crate) levels: Option<NoiseLevels>,
}
