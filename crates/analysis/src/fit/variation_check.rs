//! References that are true by name alone: a magnetic heading, or one whose variation was
//! added twice or with the wrong sign.
//!
//! The error of such a reference is a multiple of the variation. On a passage on which the
//! variation changes, no ship explains it, while one whose samples are reduced by the right
//! multiple does. In one sea the variation is a constant, like the compass's own zero: where
//! that is off by about as much, neither explanation is proven, and the band allows for both.

use crate::observation::Observation;
use binnacle_compass::angle::{CompassHeading, Variation, wrap_180};
use binnacle_compass::model::{Caution, VariationMistake};
use binnacle_compass::result::FitError;
use nalgebra::{SMatrix, SVector};

/// Number of unknowns: constant, permanent and vertically induced semicircular deviation, and
/// quadrantal deviation.
const UNKNOWNS: usize = 7;
/// Least number of rows: several for each unknown.
const NEEDED_ROWS: usize = 40;
/// Greatest number of rows that are compared.
const ENOUGH_ROWS: usize = 2000;
/// Scatter about the best ship from which instruments do not explain it, degrees: that of the
/// worst ones ([`super::check_residuals`]).
const UNEXPLAINED_DEG: f64 = 1.25;
/// Scatter below which it is arithmetic, degrees.
const LEAST_SCATTER_DEG: f64 = 0.02;
/// Part of that scatter which the right variation leaves. One change of the ship between two
/// seas leaves half about a straight line, and more about any other.
const EXPLAINED_SHARE: f64 = 1.0 / 3.0;
/// Weight of the prior of each unknown, in readings: it only keeps what they do not show
/// finite.
const PRIOR: f64 = 1e-6;
const ITERATIONS: u32 = 10;
/// Residual from which a reading loses weight, degrees.
const FULL_WEIGHT_DEG: f64 = 0.1;
/// Fields of the usual size, nT, for unknowns in degrees.
const USUAL_NT: f64 = 24_000.0;

/// Prior probability of each mistake: few installations have one.
const MISTAKE_PRIOR: f64 = 0.01;
/// Scale of the compass's zero and the reference's constant together, degrees, and their degrees
/// of freedom (docs/science.md, §7: Student's tails).
const CONSTANT_DEG: f64 = 1.0;
const CONSTANT_FREEDOM: f64 = 3.0;
/// Rows whose slow errors are one: a watch of ten-minute means.
const ROWS_OF_WATCH: f64 = 24.0;
/// Probability of a mistake from which it is said.
const CAUTION_PROBABILITY: f64 = 0.05;

/// Share of the residuals by which the scatter is measured, and the size that this share of a
/// Gaussian's does not exceed, standard deviations.
const NINTH_DECILE: f64 = 0.9;
const NINTH_DECILE_SD: f64 = 1.645;

type Columns = SVector<f64, UNKNOWNS>;

/// Row by a reference as it stands.
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub(super) compass: CompassHeading,
    pub(super) deviation_deg: f64,
    pub(super) variation: Variation,
    pub(super) h_nt: f64,
    pub(super) z_nt: f64,
}

/// Best ship for a reference less some multiple of the variation.
struct BestShip {
    constant_deg: f64,
    /// Scatter of the rows about it, degrees.
    scatter_deg: f64,
}

/// Mistake that a reference may have where the samples cannot tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PossibleMistake {
    /// Caution about it.
    pub caution: Caution,
    /// Mean square of the constant's error by it, degrees squared.
    pub variance_deg2: f64,
}

/// Checks that the variation is in a reference once, and with its sign.
///
/// # Errors
/// [`FitError::VariationMistaken`].
pub(super) fn check_variation(rows: Vec<Row>) -> Result<(), FitError> {
    let rows = thinned(rows);
    let as_read = BestShip::find(&rows, 0.0);
    let Some(as_read) = as_read.filter(|ship| ship.scatter_deg > UNEXPLAINED_DEG) else {
        return Ok(());
    };
    let mistakes = VariationMistake::ALL.into_iter().filter_map(|mistake| {
        let ship = BestShip::find(&rows, mistake.variations_in_error())?;
        Some((mistake, ship.scatter_deg))
    });
    let best = mistakes.min_by(|a, b| a.1.total_cmp(&b.1));
    match best.filter(|(_, scatter_deg)| *scatter_deg < EXPLAINED_SHARE * as_read.scatter_deg) {
        Some((mistake, explained_deg)) => Err(FitError::VariationMistaken {
            mistake,
            residual_deg: as_read.scatter_deg,
            explained_deg,
        }),
        None => Ok(()),
    }
}

/// Returns the likeliest mistake of the reference of these observations, some of so many, where the compass's
/// zero is off by about the variation and the samples do not show why; none where that is
/// unlikely.
pub fn possible_mistake(observations: &[Observation], count: u64) -> Option<PossibleMistake> {
    let rows = observations.iter().map(|o| Row {
        compass: o.compass,
        deviation_deg: o.deviation.degrees_east(),
        variation: o.variation,
        h_nt: o.h_nt,
        z_nt: o.z_nt,
    });
    let watches = count as f64 / ROWS_OF_WATCH;
    let rows = thinned(rows.collect());
    let as_read = BestShip::find(&rows, 0.0)?;
    let mistakes = VariationMistake::ALL.into_iter().filter_map(|mistake| {
        let ship = BestShip::find(&rows, mistake.variations_in_error())?;
        let by_scatter = watches * (as_read.scatter_deg / ship.scatter_deg).ln();
        let log_odds = MISTAKE_PRIOR.ln() + by_scatter + log_prior(ship.constant_deg)
            - log_prior(as_read.constant_deg);
        let probability = 1.0 / (1.0 + (-log_odds).exp());
        Some((mistake, ship.constant_deg, probability))
    });
    let (mistake, constant_deg, probability) = mistakes.max_by(|a, b| a.2.total_cmp(&b.2))?;
    (probability > CAUTION_PROBABILITY).then(|| PossibleMistake {
        caution: Caution::VariationUnproven {
            mistake,
            zero_deg: as_read.constant_deg,
        },
        variance_deg2: probability * wrap_180(as_read.constant_deg - constant_deg).powi(2),
    })
}

/// Returns the logarithm of a constant's prior density, but for a term that all share.
fn log_prior(constant_deg: f64) -> f64 {
    let z = constant_deg / CONSTANT_DEG;
    -(CONSTANT_FREEDOM + 1.0) / 2.0 * (z * z / CONSTANT_FREEDOM).ln_1p()
}

fn thinned(rows: Vec<Row>) -> Vec<Row> {
    let every = rows.len().div_ceil(ENOUGH_ROWS).max(1);
    rows.into_iter().step_by(every).collect()
}

impl BestShip {
    /// Finds the ship of least absolute residuals for a reference less so many variations; none
    /// of few rows.
    fn find(rows: &[Row], variations: f64) -> Option<BestShip> {
        if rows.len() < NEEDED_ROWS {
            return None;
        }
        let deviation_deg =
            |row: &Row| row.deviation_deg - variations * row.variation.degrees_east();
        let middle_deg = deviation_deg(&rows[rows.len() / 2]);
        let rows: Vec<(Columns, f64)> = rows
            .iter()
            .map(|row| (columns(row), wrap_180(deviation_deg(row) - middle_deg)))
            .collect();
        let mut weights = vec![1.0; rows.len()];
        let mut residuals = Vec::new();
        let mut solution = Columns::zeros();
        for _ in 0..ITERATIONS {
            let mut normal = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity() * PRIOR;
            let mut right = Columns::zeros();
            for ((columns, deviation), weight) in rows.iter().zip(&weights) {
                normal += columns * columns.transpose() * *weight;
                right += columns * (*deviation * weight);
            }
            solution = normal.cholesky()?.solve(&right);
            residuals = rows
                .iter()
                .map(|(columns, deviation)| deviation - columns.dot(&solution))
                .collect();
            weights = residuals
                .iter()
                .map(|residual: &f64| 1.0 / (residual.abs() / FULL_WEIGHT_DEG).max(1.0))
                .collect();
        }
        Some(BestShip {
            constant_deg: wrap_180(middle_deg + solution[0]),
            scatter_deg: scatter_deg(&residuals)?.max(LEAST_SCATTER_DEG),
        })
    }
}

/// Returns the standard deviation of a Gaussian with the same ninth decile of residuals: an
/// explanation must hold for nearly all rows, and a few may be wild.
fn scatter_deg(residuals: &[f64]) -> Option<f64> {
    let mut sizes: Vec<f64> = residuals.iter().map(|residual| residual.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let place = (NINTH_DECILE * sizes.len() as f64) as usize;
    Some(sizes.get(place)? / NINTH_DECILE_SD)
}

/// Returns the deviation by each unknown, to first order (Archibald Smith's coefficients by the
/// parameters: docs/science.md, §1).
fn columns(row: &Row) -> Columns {
    let (sin, cos) = row.compass.radians().sin_cos();
    let (sin_2, cos_2) = (2.0 * row.compass.radians()).sin_cos();
    let by_h = USUAL_NT / row.h_nt;
    let by_z = row.z_nt / row.h_nt;
    Columns::from([
        1.0,
        by_h * sin,
        by_h * cos,
        by_z * sin,
        by_z * cos,
        sin_2,
        cos_2,
    ])
}
