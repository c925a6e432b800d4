//! The detector's input and its findings.

use super::event::Event;
use crate::estimate::Prior;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::time::Timestamp;

/// What the search is told beside the rows.
pub(crate) struct DetectionInput<'a> {
    pub(crate) prior: &'a Prior,
    /// The sizes of noise as they were before the rows, where that is known.
    pub(crate) levels: Option<&'a NoiseLevels>,
    /// Times at which people say that something happened.
    pub(crate) reported: &'a [Timestamp],
    /// What people say of cargo that moves the compass.
    pub(crate) cargo: &'a [CargoPeriod],
}

/// Cargo that moves the compass, as the logbook has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CargoPeriod {
    pub(crate) from: Timestamp,
    /// When it was discharged; none where nobody wrote that down.
    pub(crate) to: Option<Timestamp>,
}

/// What the rows tell.
#[derive(Clone, Debug, Default)]
pub(crate) struct Detection {
    pub(crate) events: Vec<Event>,
    /// A return that may have been, and is not among the events.
    pub(crate) possible_return: Option<PossibleReturn>,
    /// A step that may have been, and is not among them either.
    pub(crate) undetected_step: Option<UndetectedStep>,
    /// What bx and by may each be off by beyond what the model knows, while a large step is
    /// neither certain nor out of question, variance in nT².
    pub(crate) undecided_step_nt2: Option<f64>,
    /// Whether a change would be among them: not of a ship of whom too little is known.
    pub(crate) is_watched: bool,
}

/// Something that is as yet neither likely enough to be believed nor unlikely
/// enough to be forgotten.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PossibleReturn {
    /// The event that would have ended.
    pub(crate) of: usize,
    /// The first row after its end.
    pub(crate) first: usize,
    pub(crate) probability: f64,
}

/// A step at a port call that may have been.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct UndetectedStep {
    /// The first row after it.
    pub(crate) first: usize,
    pub(crate) probability: f64,
}
