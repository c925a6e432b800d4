//! Epochs between the boundaries by logbook and detected changes, and their models.

mod boundaries;
mod fit;
mod quality;
mod spans;

pub(super) use boundaries::{Boundaries, begins_an_epoch};
pub(super) use fit::{Fitting, NEEDED_SAMPLES, fit_epochs, judged};
pub(super) use spans::{Span, spans};
