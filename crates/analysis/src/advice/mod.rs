//! Advice on what to sail next: the headings here, and the magnetic latitude, in which a
//! watch would narrow the band most.
//!
//! A watch is four hours on one compass heading. It shows the mean deviation there, with
//! the error that the noise levels give a mean of four hours. Its effect on the band
//! follows from the covariance alone: the measured deviation does not matter
//! (docs/science.md, §8). Three watches are on three successive days, so that the gyro's
//! slow wander is nearly the same in all of them.
//!
//! No watch widens a band. None narrows it below what the reference's own constant error
//! leaves, which no heading can show: azimuths do.

mod azimuths;
mod knowledge;
mod question;
mod ranges;
mod rank;
mod watch;

pub use question::{AdviceError, NOTICEABLE_DEG, Question};
pub use watch::{WATCH_HOURS, WATCHES};

use azimuths::azimuth_advice;
use binnacle_compass::result::{Analysis, SailNext};
use binnacle_compass::ship::EarthField;
use knowledge::{Knowledge, slopes};
use rank::{heading_advice, latitude_advice, waters_elsewhere};

/// Returns the advice after an analysis; none while there is no model.
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

/// Answers a question for advice.
///
/// # Errors
/// Fails when the model has no known uncertainty, or headings are ambiguous where the
/// vessel is or in the waters given.
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
        azimuths: azimuth_advice(&known, &own),
    })
}
