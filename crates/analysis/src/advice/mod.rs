//! What to sail next: on which headings here, and in which magnetic latitude,
//! a watch would narrow the band most.
//!
//! A watch is four hours on one compass heading; what it tells is the mean
//! deviation there, with the error that the noise levels give a mean of four
//! hours. What it would do to the band follows from the covariance alone: where
//! the deviation measured turns out to lie does not matter (docs/science.md,
//! §8). Three watches are on three successive days, so that the gyro's slow
//! wander is nearly the same in all of them.
//!
//! What always holds: no watch widens a band, and none narrows it below what
//! the reference's own constant error leaves, which no heading can show.

mod knowledge;
mod question;
mod ranges;
mod rank;
mod watch;

pub use question::{AdviceError, NOTICEABLE_DEG, Question};
pub use watch::{WATCH_HOURS, WATCHES};

use binnacle_compass::result::{Analysis, SailNext};
use binnacle_compass::ship::EarthField;
use knowledge::{Knowledge, slopes};
use rank::{heading_advice, latitude_advice, waters_elsewhere};

/// What to sail after an analysis; none while there is no model.
pub fn sail_next(analysis: &Analysis) -> Option<SailNext> {
    let epoch = analysis.current_epoch()?;
    let place = analysis.last_place?;
    let referenced = analysis
        .samples
        .iter()
        .rev()
        .find(|s| s.sample.gyro.is_some() || s.sample.satellite.is_some())?;
    advise(&Question {
        model: epoch.model.as_ref()?,
        noise: epoch.noise.as_ref()?,
        reference_constant_sd_deg: epoch.references?.constant_sd_deg,
        // Beside a satellite compass a gyro has little weight.
        gyro_share: f64::from(u8::from(referenced.sample.satellite.is_none())),
        here: EarthField {
            h_nt: place.h_nt,
            z_nt: place.z_nt,
        },
        elsewhere: &[],
        coverage: &analysis.coverage,
    })
    .ok()
}

/// What to sail next.
///
/// # Errors
/// When the model does not say how sure it is, or headings are ambiguous where
/// the ship is or in the waters given.
pub fn advise(question: &Question<'_>) -> Result<SailNext, AdviceError> {
    let known = Knowledge::new(question.model, question.reference_constant_sd_deg)?;
    let own = slopes(question.model, question.here)?;
    let here = heading_advice(question, &known, &own)?;
    let elsewhere = match waters_elsewhere(question)? {
        Some(waters) => Some(latitude_advice(question, &known, &waters)?),
        None => None,
    };
    Ok(SailNext {
        watch_hours: WATCH_HOURS,
        floor_deg: known.floor_deg(),
        here,
        elsewhere,
    })
}
