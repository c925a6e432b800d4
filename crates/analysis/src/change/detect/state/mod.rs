//! State of the detector between rows.

mod alternatives;
mod detector;
mod extra_drift;
mod leads;
mod noise_learning;
mod port_departures;

pub(crate) use alternatives::{CompetingHypothesis, NoStepHypotheses, WeakTransient};
pub(crate) use detector::{Detector, FilterBefore, earlier_state};
pub(crate) use extra_drift::ExtraDrift;
pub(crate) use leads::Leads;
pub(crate) use noise_learning::{LearningSchedule, LearntNoise};
