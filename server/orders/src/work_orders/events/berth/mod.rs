//! Events of the berth session: correctors as found, readings, plan, steps, corrector settings and photographs.

mod as_found;
mod berth_reading;
mod corrector_settings;
mod photo;
mod plan;
mod second_reading;
mod step;

pub(crate) use corrector_settings::{CorrectorMove, RevisedStrength};
pub(crate) use step::RecordedStep;
