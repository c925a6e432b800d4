//! Quality of a model: the shares of data and prior, and the number of independent samples.

use crate::state_space::ship_state::ShipState;
use binnacle_analysis::estimate::POPULATION_SD;
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::deviation::linearised_at_compass;
use binnacle_compass::model::{Caution, FromData, Identifiable, Model, Quality};
use binnacle_compass::ship::{CAUTION_H_NT, EarthField, PARAMETERS};
use nalgebra::{SMatrix, SVector};

/// Factor on the population's standard deviations for the data's own knowledge.
const WIDE_POPULATION_FACTOR: f64 = 10.0;
/// Largest part of the population's standard deviation that leaves a parameter to the data.
const DATA_DRIVEN: f64 = 0.5;
/// Factor on the samples by which more of them would suffice.
const MORE_SAMPLES_FACTOR: f64 = 10.0;
/// Ratio of the best to the worst known combination from which the worst is open.
const OPEN_RATIO: f64 = 1e12;
/// Number of headings at which the curve is evaluated.
const HEADINGS: u32 = 24;
/// Number of coefficients of a curve of deviation about its mean: B, C, D and E.
const COEFFICIENTS: f64 = 4.0;
/// Standard deviation of a usual compass's alignment, degrees.
const ALIGNMENT_DEG: f64 = 0.6;

type Matrix = SMatrix<f64, PARAMETERS, PARAMETERS>;
type Vector = SVector<f64, PARAMETERS>;

/// Knowledge behind a model.
pub(super) struct Knowledge<'a> {
    pub(super) ship: &'a ShipState,
    pub(super) prior: &'a ShipPrior,
    /// Field at the last sample, and the weakest of all.
    pub(super) earth: EarthField,
    pub(super) weakest_h_nt: f64,
    pub(super) samples: u64,
    /// Variance of a sample, degrees squared.
    pub(super) row_variance: f64,
    /// Standard deviation of the reference's constant error, degrees.
    pub(super) reference_sd_deg: f64,
}

/// Evaluates a model that has no quality yet.
pub(super) fn quality(model: &Model, known: &Knowledge<'_>) -> (Quality, Identifiable) {
    let after = in_population_units(&known.ship.covariance);
    let before = prior_covariance(known.prior);
    let information = data_information(&after, &before);
    let identifiable = identifiable(&information, known);
    let share = |j: usize| (1.0 - after[(j, j)] / before[(j, j)]).clamp(0.0, 1.0);
    let mut cautions = Vec::new();
    if !(identifiable.bx_nt && identifiable.by_nt) {
        cautions.push(missing_data(&information, known));
    }
    if known.weakest_h_nt < CAUTION_H_NT {
        cautions.push(Caution::WeakField {
            h_nt: known.weakest_h_nt,
        });
    }
    let quality = Quality {
        effective_samples: effective_samples(model, known),
        condition: condition(&information),
        from_data: FromData {
            bx_nt: share(0),
            chi13: share(1),
            by_nt: share(2),
            chi23: share(3),
            chi11_minus_chi22: share(4),
            chi12: share(5),
            chi21: share(6),
            constant_deg: constant_share(known),
        },
        cautions,
    };
    (quality, identifiable)
}

/// Returns the covariance of the parameters in units of the population.
fn in_population_units(covariance: &[[f64; PARAMETERS + 1]; PARAMETERS + 1]) -> Matrix {
    Matrix::from_fn(|i, j| covariance[i][j] / (POPULATION_SD[i] * POPULATION_SD[j]))
}

/// Returns the covariance of the prior's mixture in units of the population.
fn prior_covariance(prior: &ShipPrior) -> Matrix {
    let mean: [f64; PARAMETERS] = std::array::from_fn(|j| {
        let means = prior.components.iter().map(|c| c.weight * c.mean[j]);
        means.sum()
    });
    Matrix::from_fn(|i, j| {
        let parts = prior.components.iter().map(|c| {
            let off = (c.mean[i] - mean[i]) * (c.mean[j] - mean[j]);
            c.weight * (c.covariance[i][j] + off)
        });
        parts.sum::<f64>() / (POPULATION_SD[i] * POPULATION_SD[j])
    })
}

/// Returns the information that the data added to the prior. Where the ship is known less than
/// before, by a change, they added none.
fn data_information(after: &Matrix, before: &Matrix) -> Matrix {
    let inverse = |covariance: &Matrix| covariance.cholesky().map(|factor| factor.inverse());
    let Some((after, before)) = inverse(after).zip(inverse(before)) else {
        return Matrix::zeros();
    };
    let mut added = (after - before).symmetric_eigen();
    for value in added.eigenvalues.iter_mut() {
        *value = value.max(0.0);
    }
    added.recompose()
}

/// Returns the covariance by the data alone, with a wide population.
fn by_data(information: &Matrix) -> Option<Matrix> {
    let wide = Matrix::identity() / WIDE_POPULATION_FACTOR.powi(2);
    Some((information + wide).cholesky()?.inverse())
}

/// Returns the parameters that the data alone determine.
fn identifiable(information: &Matrix, known: &Knowledge<'_>) -> Identifiable {
    let covariance = by_data(information);
    let shown = |j: usize| covariance.is_some_and(|c| c[(j, j)].sqrt() < DATA_DRIVEN);
    // The permanent part is known only with the part that the vertical field induces.
    let (fore_and_aft, athwart) = (shown(0) && shown(1), shown(2) && shown(3));
    Identifiable {
        bx_nt: fore_and_aft,
        chi13: fore_and_aft,
        by_nt: athwart,
        chi23: athwart,
        chi11_minus_chi22: shown(4),
        chi12: shown(5),
        chi21: shown(6),
        constant_deg: constant_share(known) > 1.0 - DATA_DRIVEN * DATA_DRIVEN,
    }
}

/// Returns the share of the constant's knowledge that comes from azimuths: headings alone show
/// no more of it than the reference's constant lets them.
fn constant_share(known: &Knowledge<'_>) -> f64 {
    let information = ALIGNMENT_DEG.powi(-2) + known.reference_sd_deg.powi(-2);
    let variance = known.ship.covariance[PARAMETERS][PARAMETERS];
    (1.0 - variance * information).clamp(0.0, 1.0)
}

/// Returns the reason for which bx and χ13, by and χ23 are not separated: too few samples, or
/// one magnetic latitude.
fn missing_data(information: &Matrix, known: &Knowledge<'_>) -> Caution {
    let shown = identifiable(&(information * MORE_SAMPLES_FACTOR), known);
    if shown.bx_nt && shown.by_nt {
        Caution::FewSamples
    } else {
        Caution::OneMagneticLatitude
    }
}

/// Returns the ratio of the standard errors of the worst and the best known combination of the
/// parameters by the data alone; none where the data leave one open.
fn condition(information: &Matrix) -> Option<f64> {
    let values = information.symmetric_eigenvalues();
    let (least, most) = (values.min(), values.max());
    (least > 0.0 && most / least < OPEN_RATIO).then(|| (most / least).sqrt())
}

/// Returns the number of samples with independent errors, on headings all round, that would
/// give the curve at the last place as well: each coefficient takes one. The curve's mean, A,
/// is left out: headings alone cannot tell it from the constant.
fn effective_samples(model: &Model, known: &Knowledge<'_>) -> f64 {
    let parameters = &model.parameters_over_lambda;
    let slopes: Vec<Vector> = (0..HEADINGS)
        .filter_map(|k| {
            let compass_rad = f64::from(k * 360 / HEADINGS).to_radians();
            let (_, slopes) = linearised_at_compass(parameters, compass_rad, known.earth).ok()?;
            Some(Vector::from_fn(|j, _| slopes[j].to_degrees()))
        })
        .collect();
    let mean = slopes.iter().sum::<Vector>() / slopes.len().max(1) as f64;
    let covariance = known.ship.in_compass_axes().covariance;
    let covariance = Matrix::from_fn(|i, j| covariance[i][j]);
    let variances = slopes.iter().map(|slope| {
        let slope = slope - mean;
        slope.dot(&(covariance * slope))
    });
    let variance = variances.sum::<f64>() / slopes.len().max(1) as f64;
    (COEFFICIENTS * known.row_variance / variance.max(1e-12)).min(known.samples as f64)
}
