//! Compass error by a bearing: of the sun, another body, a transit or a charted quay.
//!
//! It is the one absolute reference on board: compass error = true bearing − compass
//! bearing, east positive (docs/science.md, §12). An [`Azimuth`] is an observation that is
//! possible in itself, with its errors worked out.

mod error;
mod form;
mod horizon;
mod observation;
mod plausibility;
mod readings;
mod result;
mod sun;

pub use error::{AzimuthError, AzimuthProblem};
pub use form::{AzimuthForm, AzimuthKind, HorizonSight};
pub use observation::Azimuth;
pub use result::{AzimuthCaution, AzimuthResult};
pub use sun::{Sun, sun_at};

#[cfg(test)]
mod tests;
