//! Quality of an estimate: the shares of data and prior, and the number of independent
//! samples.

use crate::estimate::prior::scales;
use crate::estimate::rows::Direction;
use crate::estimate::rows::Needle;
use crate::estimate::rows::{CONSTANT, UNKNOWNS};
use binnacle_compass::model::{Caution, FromData, Identifiable, Parameters, Quality};
use binnacle_compass::ship::{CAUTION_H_NT, EarthField, PARAMETERS};
use nalgebra::{SMatrix, SVector};

/// Factor on the population's standard deviations for the data's own knowledge.
const WIDE_POPULATION_FACTOR: f64 = 10.0;
/// Largest part of the population's standard deviation that leaves a parameter to the data.
const DATA_DRIVEN: f64 = 0.5;
/// Factor on the samples by which more of them would suffice.
const MORE_SAMPLES_FACTOR: f64 = 10.0;
/// Number of unknowns beside the parameters.
const OTHERS: usize = UNKNOWNS - PARAMETERS;
/// Information of a known quantity.
const KNOWN_INFORMATION: f64 = 1e9;
/// Number of headings at which the curve is evaluated.
const HEADINGS: u32 = 24;
/// Ratio of the best to the worst known combination from which the worst is open.
const OPEN_RATIO: f64 = 1e12;

type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Basis of the evaluation.
pub(crate) struct Evidence<'a> {
    /// Information of the whitened rows alone.
    pub(crate) information: &'a Matrix,
    /// Covariance by the data alone at the last row, with a wide population; none when it
    /// is not positive definite.
    pub(crate) by_data: Option<Matrix>,
    /// Information of the rows for independent errors of one degree, with their weights in
    /// the fit, and the sum of the weights.
    pub(crate) independent: &'a Matrix,
    pub(crate) weighed: f64,
    /// Residual variance of a row, degrees squared.
    pub(crate) row_variance: f64,
    /// Covariance after and before the fit, in population units.
    pub(crate) after: &'a Matrix,
    pub(crate) before: &'a SMatrix<f64, 8, 8>,
    pub(crate) parameters: &'a Parameters,
    /// Field at the last row, and the weakest of all.
    pub(crate) earth: EarthField,
    pub(crate) weakest_h_nt: f64,
}

/// Evaluates an estimate.
pub(crate) fn quality(evidence: &Evidence<'_>) -> (Quality, Identifiable) {
    let identifiable = identifiable(evidence.by_data.as_ref());
    let share = |j: usize| {
        let left = evidence.after[(j, j)] / evidence.before[(j, j)];
        (1.0 - left).clamp(0.0, 1.0)
    };
    let mut cautions = Vec::new();
    if !(identifiable.bx_nt && identifiable.by_nt) {
        cautions.push(missing_data(evidence.information));
    }
    if evidence.weakest_h_nt < CAUTION_H_NT {
        cautions.push(Caution::WeakField {
            h_nt: evidence.weakest_h_nt,
        });
    }
    let quality = Quality {
        effective_samples: effective_samples(evidence),
        condition: condition(evidence.information),
        from_data: FromData {
            bx_nt: share(0),
            chi13: share(1),
            by_nt: share(2),
            chi23: share(3),
            chi11_minus_chi22: share(4),
            chi12: share(5),
            chi21: share(6),
            constant_deg: share(CONSTANT),
        },
        cautions,
    };
    (quality, identifiable)
}

/// Returns the reason for which bx and χ13, by and χ23 are not separated: too few samples,
/// or one magnetic latitude.
fn missing_data(information: &Matrix) -> Caution {
    let more = with_wide_population(&(information * MORE_SAMPLES_FACTOR)).cholesky();
    let more = more.map(|factor| factor.inverse());
    let shown = self::identifiable(more.as_ref());
    if shown.bx_nt && shown.by_nt {
        Caution::FewSamples
    } else {
        Caution::OneMagneticLatitude
    }
}

/// Returns the number of rows with independent errors of the same size that would give the
/// curve at the last place as well as all rows do.
fn effective_samples(evidence: &Evidence<'_>) -> f64 {
    let mut independent = evidence.independent / evidence.row_variance;
    // Independent errors have no nuisances.
    for j in CONSTANT + 1..UNKNOWNS {
        independent[(j, j)] += KNOWN_INFORMATION;
    }
    let independent = with_wide_population(&independent)
        .cholesky()
        .map(|f| f.inverse());
    let Some((correlated, independent)) = evidence.by_data.zip(independent) else {
        return 0.0;
    };
    let part = curve_variance(&independent, evidence) / curve_variance(&correlated, evidence);
    (evidence.weighed * part).min(evidence.weighed)
}

/// Returns the variance of the curve at the last place, averaged over headings.
fn curve_variance(covariance: &Matrix, evidence: &Evidence<'_>) -> f64 {
    let scale = scales();
    let sum: f64 = (0..HEADINGS)
        .map(|k| {
            let magnetic = f64::from(k * 360 / HEADINGS).to_radians();
            let needle = Needle::at(
                evidence.parameters,
                Direction::from_radians(magnetic),
                evidence.earth,
            );
            let mut slopes = SVector::<f64, UNKNOWNS>::zeros();
            for (j, slope) in needle.gradient().iter().enumerate() {
                slopes[j] = slope.to_degrees() * scale[j];
            }
            slopes[CONSTANT] = needle.compass_per_magnetic() * scale[CONSTANT];
            slopes.dot(&(covariance * slopes))
        })
        .sum();
    sum / f64::from(HEADINGS)
}

/// Returns the information with a wide population.
pub(crate) fn with_wide_population(information: &Matrix) -> Matrix {
    let mut wide = *information;
    for j in 0..UNKNOWNS {
        let own = if j < PARAMETERS {
            1.0 / (WIDE_POPULATION_FACTOR * WIDE_POPULATION_FACTOR)
        } else {
            1.0
        };
        wide[(j, j)] += own;
    }
    wide
}

/// Returns the ratio of the standard errors of the worst and the best known combination of
/// the parameters, by the data alone, in population units, with the constant known to a
/// degree; none where the data leave one open.
fn condition(information: &Matrix) -> Option<f64> {
    let own = information.fixed_view::<PARAMETERS, PARAMETERS>(0, 0);
    let mixed = information.fixed_view::<PARAMETERS, OTHERS>(0, PARAMETERS);
    let others = information.fixed_view::<OTHERS, OTHERS>(PARAMETERS, PARAMETERS);
    // Their priors are one in their own units.
    let others = others + SMatrix::identity();
    let shown = own - mixed * others.cholesky()?.solve(&mixed.transpose());
    let values = shown.symmetric_eigenvalues();
    let (least, most) = (values.min(), values.max());
    (least > 0.0 && most / least < OPEN_RATIO).then(|| (most / least).sqrt())
}

/// Returns the parameters that the data alone determine, with a wide population. A is (χ21
/// − χ12)/2 and cannot be separated from the constant, so that headings show the sum of χ12
/// and χ21, E, and neither by itself.
fn identifiable(by_data: Option<&Matrix>) -> Identifiable {
    let shown =
        |j: usize| by_data.is_some_and(|covariance| covariance[(j, j)].sqrt() < DATA_DRIVEN);
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
        constant_deg: false,
    }
}
