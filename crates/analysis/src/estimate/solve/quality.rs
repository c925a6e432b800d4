//! What an estimate rests on: the data or the prior, and how many independent
//! samples the data are worth.

use crate::estimate::prior::scales;
use crate::estimate::rows::Direction;
use crate::estimate::rows::Needle;
use crate::estimate::rows::{CONSTANT, UNKNOWNS};
use binnacle_compass::model::{Caution, FromData, Identifiable, Parameters, Quality};
use binnacle_compass::ship::{CAUTION_H_NT, EarthField, PARAMETERS};
use nalgebra::{SMatrix, SVector};

/// For judging what the data alone say, the population is taken this much wider.
const WIDER: f64 = 10.0;
/// A parameter is the data's when they alone leave at most this part of the
/// population's standard deviation.
const DATA_DRIVEN: f64 = 0.5;
/// Where so many times the samples would tell a parameter, samples are what lacks.
const MORE: f64 = 10.0;
/// What is neither parameter nor told apart from A by headings.
const OTHERS: usize = UNKNOWNS - PARAMETERS;
/// Information of what is known.
const KNOWN: f64 = 1e9;
/// Headings on which the curve is looked at.
const HEADINGS: u32 = 24;
/// Data whose best and worst known combinations are further apart than this
/// leave the worst open.
const OPEN: f64 = 1e12;

type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// What there is to judge by.
pub(crate) struct Evidence<'a> {
    /// Information of the whitened rows alone.
    pub(crate) information: &'a Matrix,
    /// Covariance that the data alone leave at the last row, the population taken
    /// [`widely`]; none when they contradict all arithmetic.
    pub(crate) by_data: Option<Matrix>,
    /// What the rows would tell were their errors independent and of one degree,
    /// each with the weight it had in the fit; and the sum of the weights.
    pub(crate) independent: &'a Matrix,
    pub(crate) weighed: f64,
    /// Variance of what is left of a row, degrees squared.
    pub(crate) row_variance: f64,
    /// Covariance after the fit and before it, in population units.
    pub(crate) after: &'a Matrix,
    pub(crate) before: &'a SMatrix<f64, 8, 8>,
    pub(crate) parameters: &'a Parameters,
    /// The field at the last row, and the weakest of all.
    pub(crate) earth: EarthField,
    pub(crate) weakest_h_nt: f64,
}

/// Judges an estimate.
pub(crate) fn quality(evidence: &Evidence<'_>) -> (Quality, Identifiable) {
    let identifiable = identifiable(evidence.by_data.as_ref());
    let share = |j: usize| {
        let left = evidence.after[(j, j)] / evidence.before[(j, j)];
        (1.0 - left).clamp(0.0, 1.0)
    };
    let mut cautions = Vec::new();
    if !(identifiable.bx_nt && identifiable.by_nt) {
        cautions.push(what_lacks(evidence.information));
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

/// Why bx and χ13, by and χ23 are not told apart: more samples like these would do
/// it, or nothing will but other magnetic latitudes.
fn what_lacks(information: &Matrix) -> Caution {
    let more = widely(&(information * MORE)).cholesky();
    let more = more.map(|factor| factor.inverse());
    let told = self::identifiable(more.as_ref());
    if told.bx_nt && told.by_nt {
        Caution::FewSamples
    } else {
        Caution::OneMagneticLatitude
    }
}

/// How many rows with independent errors of the same size would tell the curve
/// at the last place as well as all rows do together.
fn effective_samples(evidence: &Evidence<'_>) -> f64 {
    let mut independent = evidence.independent / evidence.row_variance;
    // Independent errors have no nuisances.
    for j in CONSTANT + 1..UNKNOWNS {
        independent[(j, j)] += KNOWN;
    }
    let independent = widely(&independent).cholesky().map(|f| f.inverse());
    let Some((correlated, independent)) = evidence.by_data.zip(independent) else {
        return 0.0;
    };
    let part = curve_variance(&independent, evidence) / curve_variance(&correlated, evidence);
    (evidence.weighed * part).min(evidence.weighed)
}

/// Variance of the curve at the last place, averaged over headings.
fn curve_variance(covariance: &Matrix, evidence: &Evidence<'_>) -> f64 {
    let scale = scales();
    let sum: f64 = (0..HEADINGS)
        .map(|k| {
            let magnetic = f64::from(k * 360 / HEADINGS).to_radians();
            let needle = Needle::at(evidence.parameters, Direction::of(magnetic), evidence.earth);
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

/// Information with a population much wider than it is.
pub(crate) fn widely(information: &Matrix) -> Matrix {
    let mut wide = *information;
    for j in 0..UNKNOWNS {
        let own = if j < PARAMETERS {
            1.0 / (WIDER * WIDER)
        } else {
            1.0
        };
        wide[(j, j)] += own;
    }
    wide
}

/// Standard error of the worst known combination of the parameters over that of
/// the best, by the data alone, in population units, the constant known to a
/// degree; none where the data leave one quite open.
fn condition(information: &Matrix) -> Option<f64> {
    let own = information.fixed_view::<PARAMETERS, PARAMETERS>(0, 0);
    let mixed = information.fixed_view::<PARAMETERS, OTHERS>(0, PARAMETERS);
    let others = information.fixed_view::<OTHERS, OTHERS>(PARAMETERS, PARAMETERS);
    // They are known beforehand to their own units.
    let others = others + SMatrix::identity();
    let told = own - mixed * others.cholesky()?.solve(&mixed.transpose());
    let values = told.symmetric_eigenvalues();
    let (least, most) = (values.min(), values.max());
    (least > 0.0 && most / least < OPEN).then(|| (most / least).sqrt())
}

/// Which parameters the data alone tell, the population taken much wider than
/// it is. A is (χ21 − χ12)/2 and cannot be told from the constant, so that of
/// χ12 and χ21 headings tell the sum, E, and neither by itself.
fn identifiable(by_data: Option<&Matrix>) -> Identifiable {
    let told = |j: usize| by_data.is_some_and(|covariance| covariance[(j, j)].sqrt() < DATA_DRIVEN);
    // What is permanent is known only when what the dip induces is.
    let (fore_and_aft, athwart) = (told(0) && told(1), told(2) && told(3));
    Identifiable {
        bx_nt: fore_and_aft,
        chi13: fore_and_aft,
        by_nt: athwart,
        chi23: athwart,
        chi11_minus_chi22: told(4),
        chi12: told(5),
        chi21: told(6),
        constant_deg: false,
    }
}
