//! Findings of the detector in one epoch of the logbook.

use crate::estimate::Prior;
use binnacle_compass::result::{Cause, Change, NoiseLevels};
use binnacle_compass::time::Timestamp;

/// Work may have been done so long before the logbook says so, or after, seconds: people
/// write down when they noticed, or what was planned.
pub(crate) const MISTIMED_S: f64 = 86_400.0;

/// What was found in one epoch of the logbook.
pub(crate) struct Found {
    pub(crate) changes: Vec<Change>,
    /// Where epochs begin beside the logbook's.
    pub(crate) boundaries: Vec<Boundary>,
    /// The end that a change may have had, if that is open.
    pub(crate) possible_return: Option<Ended>,
    /// A change that may have begun at a port call, and has not been told.
    pub(crate) undetected_step: Option<Begun>,
    /// A zero that may have moved in place of the only reference's.
    pub(crate) misled: Option<Misled>,
    /// What a step that is not certain may have done to bx and by, variance in nT².
    pub(crate) undecided_step_nt2: Option<f64>,
    /// True if a change would have been noticed.
    pub(crate) is_watched: bool,
}

impl Found {
    /// When the work was done of which the logbook says that it was done at a time soon
    /// after: people write down when they noticed.
    pub(crate) fn reported_late(&self, said: Timestamp) -> Option<Timestamp> {
        let last = self.boundaries.last().filter(|last| !last.resumes)?;
        (self.is_work(last) && said.seconds_since(last.at) < MISTIMED_S).then_some(last.at)
    }

    /// When the work was done of which the logbook says that it was done at a time before.
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

/// A change that may be over.
pub(crate) struct Ended {
    /// When it would have ended.
    pub(crate) at: Timestamp,
    /// Its place in the list.
    pub(crate) change: usize,
    pub(crate) probability: f64,
}

/// A change that may have begun.
pub(crate) struct Begun {
    pub(crate) at: Timestamp,
    pub(crate) probability: f64,
}

/// A compass whose zero may have moved, by so much, degrees, with that variance.
pub(crate) struct Misled {
    pub(crate) moved_deg: f64,
    pub(crate) variance: f64,
    pub(crate) probability: f64,
}

/// The beginning of an epoch that a change made.
pub(crate) struct Boundary {
    pub(crate) at: Timestamp,
    /// The change's place in the list.
    pub(crate) change: usize,
    /// True if the change ended here, and the ship is as she was before it.
    pub(crate) resumes: bool,
}

/// What is known beforehand of the ship and of her instruments' noise.
pub(crate) struct Known {
    pub(crate) prior: Prior,
    pub(crate) levels: Option<NoiseLevels>,
}
