//! Measured less predicted deviation of samples, and the courses that they lie on.

use binnacle_compass::angle::wrap_180;
use binnacle_compass::model::Model;
use binnacle_compass::result::SampleDiagnostic;
use binnacle_compass::ship::EarthField;

/// Greatest length of a course, and of a gap in it, seconds.
const COURSE_S: f64 = 4.0 * 3600.0;
const GAP_S: f64 = 3600.0;
/// Change of heading that ends a course, degrees.
const TURN_DEG: f64 = 15.0;

/// Measured less predicted deviation of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residual<'a> {
    pub(super) sample: &'a SampleDiagnostic,
    pub(super) h_nt: f64,
    pub(super) off_deg: f64,
    /// Standard error of the model's prediction, degrees.
    pub(super) model_deg: f64,
}

/// Returns the residual of a sample; none without a deviation.
pub(super) fn residual<'a>(model: &Model, sample: &'a SampleDiagnostic) -> Option<Residual<'a>> {
    let measured_deg = sample.deviation_deg?;
    let (h_nt, z_nt) = sample.h_nt.zip(sample.z_nt)?;
    let earth = EarthField { h_nt, z_nt };
    let predicted = model.deviation(sample.sample.compass, earth).ok()?;
    Some(Residual {
        sample,
        h_nt,
        off_deg: wrap_180(measured_deg - predicted.deviation.degrees_east()),
        model_deg: predicted.standard_error_deg?,
    })
}

/// Splits residuals in order of time where the vessel turned, paused or four hours are over.
pub(super) fn split_into_courses<'a, 'b>(residuals: &'b [Residual<'a>]) -> Vec<&'b [Residual<'a>]> {
    let mut courses = Vec::new();
    let mut begin = 0;
    for end in 1..=residuals.len() {
        let goes_on = residuals.get(end).is_some_and(|next| {
            let (first, last) = (
                &residuals[begin].sample.sample,
                &residuals[end - 1].sample.sample,
            );
            let next = &next.sample.sample;
            next.time.seconds_since(first.time) < COURSE_S
                && next.time.seconds_since(last.time) < GAP_S
                && wrap_180(next.compass.degrees() - first.compass.degrees()).abs() <= TURN_DEG
        });
        if !goes_on {
            courses.push(&residuals[begin..end]);
            begin = end;
        }
    }
    courses
}
