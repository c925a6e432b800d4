//! Input and result of the detector.

use super::event::Event;
use crate::estimate::Prior;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::time::Timestamp;

/// Input of the detector beside the rows.
pub(crate) struct DetectionInput<'a> {
    pub(crate) prior: &'a Prior,
    /// Noise levels before the rows, where they are known.
    pub(crate) levels: Option<&'a NoiseLevels>,
    /// Times at which people reported an event.
    pub(crate) reported: &'a [Timestamp],
    /// Magnetic cargo by the logbook.
    pub(crate) cargo: &'a [CargoPeriod],
}

/// Time on board of magnetic cargo, by the logbook.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CargoPeriod {
    pub(crate) from: Timestamp,
    /// Time of discharge; none where it was not recorded.
    pub(crate) to: Option<Timestamp>,
}

/// Result of the detector.
#[derive(Clone, Debug, Default)]
pub(crate) struct Detection {
    pub(crate) events: Vec<Event>,
    /// A possible return that is not among the events.
    pub(crate) possible_return: Option<PossibleReturn>,
    /// A possible step that is not among the events.
    pub(crate) undetected_step: Option<UndetectedStep>,
    /// Variance that an undecided large step adds to bx and to by, nT².
    pub(crate) undecided_step_nt2: Option<f64>,
    /// True if changes are detected: not while too little is known of the vessel.
    pub(crate) is_watched: bool,
}

/// A return whose probability is too low to be accepted and too high to be dismissed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PossibleReturn {
    /// Place of the event that would have ended.
    pub(crate) event: usize,
    /// First row after the end.
    pub(crate) first: usize,
    pub(crate) probability: f64,
}

/// A possible step at a port call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct UndetectedStep {
    /// First row after the step.
    pub(crate) first: usize,
    pub(crate) probability: f64,
}
