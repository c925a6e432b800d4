//! Prediction of one part of a recording by the model of another part.

use super::reference_noise::ReferenceNoise;
use super::residual::{Residual, residual, split_into_courses};
use binnacle_compass::result::{Analysis, FitError, SampleDiagnostic, expected_inside};
use serde::Serialize;

/// Width of a sector of the table, degrees.
const SECTOR_DEG: usize = 30;
/// Half the width of a 95 % band, standard deviations.
const BAND_SD: f64 = 1.96;

/// Outcome of predicting samples that the model has not seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeldOut {
    /// Samples with a deviation.
    pub samples: u64,
    /// Courses: samples on one heading, four hours at most.
    pub courses: u32,
    /// Courses whose mean lies in the 95 % band of model and reference.
    pub courses_inside: u32,
    /// Fewest courses inside that a right band may have by chance, at 95 %.
    pub expected_from: u32,
    /// Most courses inside that a right band may have by chance, at 95 %.
    pub expected_to: u32,
    /// Mean of measured less predicted deviation over the samples, degrees.
    pub mean_deg: f64,
    /// Root mean square of measured less predicted deviation, degrees.
    pub rms_deg: f64,
    /// Half the width of the model's own 95 % band, root mean square, degrees.
    pub band_deg: f64,
    /// Sectors of compass heading with samples.
    pub sectors: Vec<Sector>,
}

/// Residuals of one sector of compass heading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Sector {
    /// First heading, degrees.
    pub from_deg: u32,
    /// End, degrees.
    pub to_deg: u32,
    /// Samples.
    pub samples: u64,
    /// Mean of measured less predicted deviation, degrees.
    pub mean_deg: f64,
    /// Root mean square of measured less predicted deviation, degrees.
    pub rms_deg: f64,
    /// Half the width of the model's own 95 % band, root mean square, degrees.
    pub band_deg: f64,
}

/// Predicts the samples of a part of a recording that another analysis has not seen.
///
/// # Errors
/// Fails when that analysis has no model.
pub(super) fn held_out<'a>(
    learnt: &Analysis,
    samples: impl Iterator<Item = &'a SampleDiagnostic>,
) -> Result<HeldOut, FitError> {
    let epoch = learnt.current_epoch();
    let Some((epoch, model)) = epoch.and_then(|epoch| Some((epoch, epoch.model.as_ref()?))) else {
        let refusal = epoch.and_then(|epoch| epoch.refusal.clone());
        return Err(refusal.unwrap_or(FitError::TooFewSamples {
            found: 0,
            needed: 1,
        }));
    };
    let residuals: Vec<Residual<'_>> = samples.filter_map(|s| residual(model, s)).collect();
    let noise = ReferenceNoise::new(epoch, learnt.predictions);
    let (mut courses, mut courses_inside) = (0, 0);
    for course in split_into_courses(&residuals) {
        let n = course.len() as f64;
        let off_deg = course.iter().map(|r| r.off_deg).sum::<f64>() / n;
        let model_variance = course.iter().map(|r| r.model_deg.powi(2)).sum::<f64>() / n;
        let variance = model_variance + noise.variance(course);
        courses += 1;
        courses_inside += u32::from(off_deg.abs() <= BAND_SD * variance.sqrt());
    }
    let expected = expected_inside(courses);
    let all = sector(0, &residuals);
    Ok(HeldOut {
        samples: all.samples,
        courses,
        courses_inside,
        expected_from: *expected.start(),
        expected_to: *expected.end(),
        mean_deg: all.mean_deg,
        rms_deg: all.rms_deg,
        band_deg: all.band_deg,
        sectors: sectors(&residuals),
    })
}

fn sectors(residuals: &[Residual<'_>]) -> Vec<Sector> {
    let of = |k: usize| {
        let within = residuals.iter().filter(|r| {
            let compass_deg = r.sample.sample.compass.degrees();
            compass_deg as usize / SECTOR_DEG == k
        });
        sector(k, &within.copied().collect::<Vec<_>>())
    };
    let all = (0..360 / SECTOR_DEG).map(of);
    all.filter(|sector| sector.samples > 0).collect()
}

fn sector(number: usize, residuals: &[Residual<'_>]) -> Sector {
    let n = (residuals.len() as f64).max(1.0);
    let sum = |of: fn(&Residual<'_>) -> f64| residuals.iter().map(of).sum::<f64>();
    Sector {
        from_deg: (number * SECTOR_DEG) as u32,
        to_deg: ((number + 1) * SECTOR_DEG) as u32,
        samples: residuals.len() as u64,
        mean_deg: sum(|r| r.off_deg) / n,
        rms_deg: (sum(|r| r.off_deg.powi(2)) / n).sqrt(),
        band_deg: BAND_SD * (sum(|r| r.model_deg.powi(2)) / n).sqrt(),
    }
}
