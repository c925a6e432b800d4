//! Against the field: the published fit, ordinary least squares, Huber's weights
//! and the product's fit on the same voyages, as the table that README.md shows.
//!
//! Errors are of the predicted deviation at the ship's last place, root mean
//! square over headings and ships, over the Cramér–Rao bound of the same ships.
//! The gyro's constant error, which no heading can tell, is counted to the truth
//! for every method, and its variance, which only the product allows for, is
//! taken off the product's band.
//!
//! Takes half an hour: `make methods`, or
//! `cargo run --release -p binnacle-analysis --example methods [SHIPS]`.

#![allow(clippy::unwrap_used)] // a study, run by hand

#[allow(dead_code)]
#[path = "../tests/voyages/mod.rs"]
mod voyages;

use binnacle_analysis::fit::{Observation, RobustOptions, fit_ols, fit_paper, fit_robust};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::model::Model;
use binnacle_compass::result::FitError;
use voyages::bound::{HEADINGS, bound, fair};
use voyages::{Faults, Truth, Variety, Voyage, predicted, true_deviation};

type Fit = fn(&[Observation]) -> Result<Model, FitError>;

const METHODS: [(&str, Fit); 4] = [
    ("the paper's, a sample each 15°", paper),
    ("ordinary least squares", fit_ols),
    ("Huber's weights", huber),
    ("**Binnacle**", product),
];
const VARIETIES: [(&str, Variety); 3] = [
    ("both hemispheres", Variety::Rich),
    ("one ocean", Variety::Medium),
    ("one sea", Variety::Poor),
];
/// Long enough that most headings are sailed: the paper's fit has its points.
const DAYS: f64 = 30.0;
/// No other study sails these.
const FIRST_SEED: u64 = 20_000;

fn main() {
    let ships = std::env::args().nth(1);
    let ships = ships.map_or(70, |n| n.parse().expect("the number of ships"));
    let groups = VARIETIES.map(|(_, variety)| scores(variety, ships));
    let columns = VARIETIES.map(|(name, _)| name).join(" | ");
    println!("| method | {columns} | refused |\n|---|---|---|---|---|");
    for (index, (name, _)) in METHODS.iter().enumerate() {
        let cells = groups.each_ref().map(|group| group[index].cell());
        let refused: u64 = groups.iter().map(|group| group[index].refused).sum();
        let sailed = 3 * ships;
        println!("| {name} | {} | {refused} of {sailed} |", cells.join(" | "));
    }
}

/// Outcome of one method's models of one group of ships.
#[derive(Clone, Copy, Default)]
struct Score {
    refused: u64,
    answered: u64,
    /// Mean square errors, summed over ships.
    squares: f64,
    /// The bounds of the same ships.
    bounds: f64,
    /// Shares of headings held by the band, summed over ships.
    held: f64,
}

impl Score {
    fn cell(&self) -> String {
        let error = (self.squares / self.bounds).sqrt();
        let held = 100.0 * self.held / self.answered as f64;
        format!("{error:.2} × ({held:.0} %)")
    }
}

fn scores(variety: Variety, ships: u64) -> [Score; METHODS.len()] {
    let mut scores = [Score::default(); METHODS.len()];
    for seed in FIRST_SEED..FIRST_SEED + ships {
        let voyage = fair(seed, variety, DAYS, &Faults::USUAL);
        let bound = bound(&voyage, voyage.truth.h_nt, voyage.truth.z_nt);
        for (score, (_, fit)) in scores.iter_mut().zip(METHODS) {
            let Some((square, held)) = fit(&voyage.observations)
                .ok()
                .and_then(|model| judge(&model, &voyage))
            else {
                score.refused += 1;
                continue;
            };
            score.answered += 1;
            score.squares += square;
            score.bounds += bound;
            score.held += held;
        }
    }
    scores
}

/// Returns the mean square error of the curve at the last place, and the share of headings
/// whose band holds the truth; none where the model has ambiguous headings there.
fn judge(model: &Model, voyage: &Voyage) -> Option<(f64, f64)> {
    let Truth { h_nt, z_nt, .. } = voyage.truth;
    let (mut squares, mut held) = (0.0, 0.0);
    for heading in 0..HEADINGS {
        let compass = heading as f64 * 10.0;
        let exact = true_deviation(&voyage.truth, compass, h_nt, z_nt);
        let (found, standard_error) = predicted(model, compass, h_nt, z_nt);
        if !found.is_finite() {
            return None;
        }
        let error = wrap_180(found - exact - voyage.reference_constant_deg());
        squares += error * error / HEADINGS as f64;
        if error.abs() <= 1.96 * standard_error {
            held += 1.0 / HEADINGS as f64;
        }
    }
    Some((squares, held))
}

/// The sample nearest to each 15° of heading, as the authors had.
fn paper(observations: &[Observation]) -> Result<Model, FitError> {
    let nearest = |to: f64| {
        let off = |o: &&Observation| wrap_180(o.compass.degrees() - to).abs();
        let near = observations.iter().filter(|o| off(o) < 7.5);
        near.min_by(|a, b| off(a).total_cmp(&off(b))).copied()
    };
    let points: Vec<Observation> = (0..24)
        .filter_map(|k| nearest(f64::from(k) * 15.0))
        .collect();
    fit_paper(&points)
}

/// Ordinary least squares, reweighted until the weights settle.
fn huber(observations: &[Observation]) -> Result<Model, FitError> {
    // 95 % as efficient as least squares where noise is Gaussian.
    const TUNING: f64 = 1.345;
    const MEDIAN_TO_SD: f64 = 0.674_489_8;
    let plain = fit_ols(observations)?;
    let mut model = plain.clone();
    let mut rows = observations.to_vec();
    let mut variance = 0.0;
    for _ in 0..30 {
        let residuals: Vec<f64> = rows.iter().map(|o| residual_deg(&model, o)).collect();
        let mut sizes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let allowed = TUNING * sizes[sizes.len() / 2] / MEDIAN_TO_SD;
        for (row, residual) in rows.iter_mut().zip(residuals) {
            row.weight = (allowed / residual.abs()).min(1.0);
        }
        model = fit_ols(&rows)?;
        // Huber, Robust Statistics, eq. 6.5: E ψ² / (E ψ')², times (XᵀX)⁻¹.
        let squares: f64 = sizes.iter().map(|r| r.min(allowed).powi(2)).sum();
        let inside = sizes.partition_point(|r| *r <= allowed) as f64;
        variance = squares * sizes.len() as f64 / (inside * inside);
    }
    let wider = variance / plain.rms_deg.unwrap().powi(2);
    let covariance = plain.covariance.unwrap();
    model.covariance = Some(covariance.map(|row| row.map(|value| wider * value)));
    Ok(model)
}

fn residual_deg(model: &Model, o: &Observation) -> f64 {
    let (found, _) = predicted(model, o.compass.degrees(), o.h_nt, o.z_nt);
    wrap_180(o.deviation.degrees_east() - found)
}

fn product(observations: &[Observation]) -> Result<Model, FitError> {
    let options = RobustOptions::default();
    let mut model = fit_robust(observations, &options)?.model;
    if let Some(covariance) = &mut model.covariance {
        covariance[7][7] -= options.reference_constant_sd_deg.powi(2);
    }
    Ok(model)
}
