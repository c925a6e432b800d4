//! The product's fit: exact model, residuals in angle, robust weights, correlated noise,
//! and a prior for what headings cannot show.

use super::heading_check::check_headings;
use super::variation_check::possible_mistake;
use super::{residual_check, time_outliers};
use crate::estimate::{Options, Prior, Turn, estimate};
use crate::observation::{Observation, mean_h_nt};
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::model::{Model, Parameters, ReferenceGrade};
use binnacle_compass::result::{FitError, NoiseLevels};
use binnacle_compass::settings::REFERENCE_CONSTANT_SD_DEG;
use binnacle_compass::ship::{EarthField, PARAMETERS, WEAKEST_H_NT};
use std::borrow::Cow;

/// Least number of samples for a fit of eight unknowns.
const NEEDED_SAMPLES: u64 = 12;
/// Weight below which a row counts as rejected.
pub const REJECTED_BELOW: f64 = 0.5;

/// Options of a robust fit.
#[derive(Clone, Debug, PartialEq)]
pub struct RobustOptions {
    /// Prior knowledge of the vessel; ships at large when there is none.
    pub prior: Prior,
    /// Standard deviation of the reference's constant error, degrees.
    pub reference_constant_sd_deg: f64,
}

impl RobustOptions {
    /// Returns the options for a vessel of which nothing is known yet.
    pub fn for_unknown_vessel(reference_constant_sd_deg: f64) -> RobustOptions {
        RobustOptions {
            prior: Prior::population(reference_constant_sd_deg),
            reference_constant_sd_deg,
        }
    }
}

impl Default for RobustOptions {
    fn default() -> RobustOptions {
        RobustOptions::for_unknown_vessel(REFERENCE_CONSTANT_SD_DEG)
    }
}

/// A model with the outcome of every observation.
#[derive(Clone, Debug, PartialEq)]
pub struct RobustFit {
    /// The model.
    pub model: Model,
    /// Noise levels found by the estimator.
    pub noise: NoiseLevels,
    /// Outcome of each observation, in the order given.
    pub rows: Vec<RowOutcome>,
}

/// Outcome of one observation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowOutcome {
    /// Measured less predicted, degrees; none where the row was not used.
    pub residual_deg: Option<f64>,
    /// Weight, 0 to 1: 0 where the field is too weak for a compass.
    pub weight: f64,
}

/// Fits a model to observations in any order.
///
/// # Errors
/// Fails when the observations cannot carry a model, with what is missing.
pub fn fit_robust(
    observations: &[Observation],
    options: &RobustOptions,
) -> Result<RobustFit, FitError> {
    let usable = usable(observations);
    let rows = chosen(observations, &usable);
    check_field(observations)?;
    check_number(&rows, NEEDED_SAMPLES)?;
    check_headings(&rows)?;
    let turn = Turn::find(&rows, &options.prior);
    fit_usable(observations, &usable, &rows, options, turn)
}

/// Returns the places of the observations that a fit may use.
fn usable(observations: &[Observation]) -> Vec<usize> {
    let mut usable: Vec<usize> = (0..observations.len())
        .filter(|&i| is_usable(&observations[i]))
        .collect();
    time_outliers::leave_out_early(observations, &mut usable);
    usable
}

/// Returns the observations in these places, which are in order.
fn chosen<'a>(observations: &'a [Observation], places: &[usize]) -> Cow<'a, [Observation]> {
    if places.len() == observations.len() {
        return Cow::Borrowed(observations);
    }
    places.iter().map(|&i| observations[i]).collect()
}

/// Returns true if a compass can work in the field, and the weight is above zero.
pub(super) fn is_usable(o: &Observation) -> bool {
    o.h_nt >= WEAKEST_H_NT && o.weight > 0.0
}

fn fit_usable(
    observations: &[Observation],
    usable: &[usize],
    rows: &[Observation],
    options: &RobustOptions,
    turn: Option<Turn>,
) -> Result<RobustFit, FitError> {
    let fitted = estimate(
        rows,
        &Options {
            prior: &options.prior,
            reference_constant_sd_deg: options.reference_constant_sd_deg,
            turn,
        },
    )
    .ok_or(FitError::NotConverged)?;
    let used = fitted.rows.iter().filter(|r| r.weight >= REJECTED_BELOW);
    let squares: f64 = used.clone().map(|r| r.residual_deg.powi(2)).sum();
    let samples_used = used.count() as u64;
    let residuals = fitted.rows.iter().map(|row| row.residual_deg);
    let caution = residual_check::check_residuals(residuals, &fitted.levels)?;
    residual_check::check_used(samples_used, rows.len() as u64)?;
    check_needle(&fitted.parameters, rows)?;
    let mut quality = fitted.quality;
    quality.cautions.extend(caution);
    quality.cautions.extend(time_outliers::long_gap(rows));
    let mut covariance = fitted.covariance;
    if let Some(possible) = possible_mistake(rows, rows.len() as u64) {
        covariance[PARAMETERS][PARAMETERS] += possible.variance_deg2;
        quality.cautions.push(possible.caution);
    }

    let mut outcomes = vec![
        RowOutcome {
            residual_deg: None,
            weight: 0.0
        };
        observations.len()
    ];
    for (&index, row) in usable.iter().zip(&fitted.rows) {
        outcomes[index] = RowOutcome {
            residual_deg: Some(row.residual_deg),
            weight: row.weight,
        };
    }
    let model = Model {
        parameters_over_lambda: fitted.parameters,
        constant_deg: fitted.constant_deg,
        covariance: Some(covariance),
        identifiable: Some(fitted.identifiable),
        rms_deg: Some((squares / samples_used.max(1) as f64).sqrt()),
        samples_used,
        samples_rejected: observations.len() as u64 - samples_used,
        quality: Some(quality),
        reference_grade: ReferenceGrade::Heading,
        mean_h_nt: mean_h_nt(rows),
        needles: None,
    };
    Ok(RobustFit {
        model,
        noise: fitted.levels,
        rows: outcomes,
    })
}

/// Fails when no observation has weight and a field for a compass.
pub(super) fn check_field(all: &[Observation]) -> Result<(), FitError> {
    let weighed = all.iter().filter(|o| o.weight > 0.0).map(|o| o.h_nt);
    match weighed.reduce(f64::max) {
        Some(strongest_nt) if strongest_nt < WEAKEST_H_NT => Err(FitError::FieldTooWeak {
            strongest_nt,
            needed_nt: WEAKEST_H_NT,
        }),
        None if !all.is_empty() => Err(FitError::NoWeight {
            samples: all.len() as u64,
        }),
        _ => Ok(()),
    }
}

fn check_number(rows: &[Observation], needed: u64) -> Result<(), FitError> {
    let found = rows.len() as u64;
    if found >= needed {
        return Ok(());
    }
    Err(FitError::TooFewSamples { found, needed })
}

/// Fails when one compass heading stands for several courses in the usual field.
fn check_needle(p: &Parameters, rows: &[Observation]) -> Result<(), FitError> {
    let mut fields: Vec<(f64, f64)> = rows.iter().map(|o| (o.h_nt, o.z_nt)).collect();
    let middle = fields.len() / 2;
    let (_, &mut (h_nt, z_nt), _) =
        fields.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let earth = EarthField { h_nt, z_nt };
    Coefficients::new(p, earth)
        .and_then(|coefficients| coefficients.check_unambiguous())
        .map_err(|_| FitError::AmbiguousHeadings { h_nt })
}
