//! Likelihoods of shared and of independent noise.

use super::curve::Residuals;
use std::f64::consts::TAU;

/// Digits of both instruments, degrees; 0 where there are none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Digits {
    pub(super) compass_deg: f64,
    pub(super) reference_deg: f64,
}

/// Comparison of the two explanations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evidence {
    /// Mean log-likelihood of a pair by shared noise.
    pub(super) shared: f64,
    /// Mean log-likelihood of a pair by independent noise.
    pub(super) independent: f64,
    /// Scatter of the differences about the curve, degrees.
    pub(super) scatter_deg: f64,
}

/// Least noise of independent instruments beside their digits, degrees. A compass of class A
/// has a card friction of up to (3/H)°, H in µT [ISO 25862]: 0.12° at 24 µT, spread evenly
/// 0.07°. Transmitting sensors (±0.2°) and gyros are no better.
const LEAST_NOISE_DEG: f64 = 0.07;
/// Ratio of one tried noise level to the next, and their number: up to 6°.
const NOISE_STEP: f64 = 1.35;
const NOISE_LEVELS: i32 = 15;
/// Error of a copy beside its digits, degrees: interpolation, and another model's variation.
pub(super) const COPY_DEG: f64 = 0.02;
/// Share of wild readings under either explanation, each anywhere on the circle.
const WILD_SHARE: f64 = 0.02;
/// Number of points for each of two rounding errors, and for one alone, whose edges are sharp.
const ROUNDING_POINTS: i32 = 24;
const SINGLE_ROUNDING_POINTS: i32 = 96;
/// Distance beyond which a Gaussian is negligible beside wild readings, standard deviations.
const NEGLIGIBLE_SD: f64 = 6.0;
/// Number of tried constants of a copy.
const CONSTANTS: usize = 3;
/// Share of the differences at either end that may be wild.
const TRIMMED_SHARE: f64 = 0.005;
/// Steepest mean slope of a card by which a copy was corrected, degrees a degree: that of a
/// compass of 28° semicircular deviation on its steepest headings.
const STEEPEST_CARD: f64 = 0.5;
/// Steps of a table of densities in a standard deviation.
const STEPS_PER_SD: f64 = 8.0;

/// Returns the least scatter of independent instruments with these digits, degrees.
pub(super) fn least_scatter_deg(digits: Digits) -> f64 {
    let rounding = (digits.compass_deg.powi(2) + digits.reference_deg.powi(2)) / 12.0;
    (rounding + LEAST_NOISE_DEG * LEAST_NOISE_DEG).sqrt()
}

/// Weighs shared against independent noise.
pub(super) fn weigh(residuals: &Residuals, digits: Digits) -> Evidence {
    let count = residuals.degrees.len() as f64;
    let Digits {
        compass_deg,
        reference_deg,
    } = digits;
    // A copy of the digits shown, or of the reading before these. What it shows is in its own
    // digits: between them nothing is likelier than within.
    let ways = [
        Roundings::of(0.0, reference_deg),
        Roundings::of(compass_deg, reference_deg),
    ];
    let is_card = residuals.slope.abs() <= STEEPEST_CARD;
    let corrected = ways.iter().filter(|_| is_card).map(|way| {
        // The curve follows the rounding errors by so much.
        let curve = way.variance() * residuals.unknowns as f64 / count;
        way.mean_log_density(&residuals.degrees, (COPY_DEG * COPY_DEG + curve).sqrt())
    });
    // No curve at all, but a constant.
    let without_curve: Vec<Vec<f64>> = constants(residuals)
        .into_iter()
        .map(|constant_deg| {
            let differences = residuals.differences_deg.iter();
            differences.map(|d| d - constant_deg).collect()
        })
        .collect();
    let plain = without_curve
        .iter()
        .flat_map(|off| ways.iter().map(|way| way.mean_log_density(off, COPY_DEG)));
    let shared = corrected.chain(plain).fold(f64::NEG_INFINITY, f64::max);
    let independent = without_curve
        .iter()
        .chain([&residuals.degrees])
        .map(|off| independent_log_density(&ways[ways.len() - 1], off))
        .fold(f64::NEG_INFINITY, f64::max);
    let choices = ways.len() as f64 * (CONSTANTS + 1) as f64;
    let scatters = without_curve.iter().chain([&residuals.degrees]);
    Evidence {
        shared: shared - choices.ln() / count,
        independent,
        scatter_deg: scatters
            .map(|off| root_mean_square(off))
            .fold(f64::INFINITY, f64::min),
    }
}

/// Returns the greatest mean log-density of residuals under independent noise of any level.
fn independent_log_density(roundings: &Roundings, residuals_deg: &[f64]) -> f64 {
    independent_levels_deg()
        .map(|noise_deg| roundings.mean_log_density(residuals_deg, noise_deg))
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Returns the tried levels of independent noise, degrees, the least first.
pub(super) fn independent_levels_deg() -> impl Iterator<Item = f64> {
    (0..NOISE_LEVELS).map(|level| LEAST_NOISE_DEG * NOISE_STEP.powi(level))
}

/// Returns the log-density per degree of Gaussian noise, with a share of wild readings.
pub(super) fn log_density(off_deg: f64, sd_deg: f64) -> f64 {
    let z = off_deg / sd_deg;
    with_wild((-z * z / 2.0).exp() / (sd_deg * TAU.sqrt()))
}

fn with_wild(density: f64) -> f64 {
    ((1.0 - WILD_SHARE) * density + WILD_SHARE / 360.0).ln()
}

fn root_mean_square(numbers: &[f64]) -> f64 {
    let squares: f64 = numbers.iter().map(|x| x * x).sum();
    (squares / numbers.len() as f64).sqrt()
}

/// Returns the constants that a copy may have: none, the middle difference, and the middle of
/// all but the wildest, which is the best of evenly spread ones.
fn constants(residuals: &Residuals) -> [f64; CONSTANTS] {
    let mut sorted = residuals.differences_deg.clone();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let place = (share * (sorted.len().max(1) - 1) as f64).round() as usize;
        sorted.get(place).copied().unwrap_or_default()
    };
    let ends = f64::midpoint(at(TRIMMED_SHARE), at(1.0 - TRIMMED_SHARE));
    [residuals.none_deg, at(0.5), ends]
}

/// Sum of two rounding errors, each even within its digit.
struct Roundings {
    /// Errors and their probabilities.
    points: Vec<(f64, f64)>,
    digits_deg: [f64; 2],
    /// Distance between the points, degrees.
    spacing_deg: f64,
}

impl Roundings {
    fn of(one_deg: f64, other_deg: f64) -> Roundings {
        let count = if other_deg > 0.0 && one_deg > 0.0 {
            ROUNDING_POINTS
        } else {
            SINGLE_ROUNDING_POINTS
        };
        let errors = |digit_deg: f64| {
            let count = if digit_deg > 0.0 { count } else { 1 };
            (0..count)
                .map(move |part| digit_deg * ((f64::from(part) + 0.5) / f64::from(count) - 0.5))
        };
        let points =
            errors(one_deg).flat_map(|one| errors(other_deg).map(move |other| (one + other, 1.0)));
        Roundings {
            points: merged(points.collect()),
            digits_deg: [one_deg, other_deg],
            spacing_deg: one_deg.max(other_deg) / f64::from(count),
        }
    }

    fn variance(&self) -> f64 {
        self.digits_deg
            .iter()
            .map(|digit| digit * digit / 12.0)
            .sum()
    }

    /// Returns the mean log-density of residuals, a few of them wild.
    fn mean_log_density(&self, residuals_deg: &[f64], noise_deg: f64) -> f64 {
        let [one, other] = self.digits_deg;
        // A point stands for the part of a digit about it.
        let sd = noise_deg.max(self.spacing_deg);
        let step = sd / STEPS_PER_SD;
        let widest = f64::midpoint(one, other) + NEGLIGIBLE_SD * sd;
        // The density is even, and beside wild readings nothing beyond its end.
        let places = 0..=(widest / step).ceil() as usize;
        let table: Vec<f64> = places
            .map(|k| self.log_density(k as f64 * step, sd))
            .collect();
        let logs = residuals_deg.iter().map(|residual_deg| {
            let place = (residual_deg.abs() / step) as usize;
            let part = residual_deg.abs() / step - place as f64;
            let last = table[table.len() - 1];
            let at = |place: usize| table.get(place).copied().unwrap_or(last);
            at(place) + part * (at(place + 1) - at(place))
        });
        logs.sum::<f64>() / residuals_deg.len() as f64
    }

    /// Returns the log-density per degree of a residual with additional noise.
    fn log_density(&self, residual_deg: f64, sd_deg: f64) -> f64 {
        let kernels = self.points.iter().map(|(error, probability)| {
            let z = (residual_deg - error) / sd_deg;
            probability * (-z * z / 2.0).exp()
        });
        let density = kernels.sum::<f64>() / (sd_deg * TAU.sqrt());
        with_wild(density)
    }
}

/// Merges equal points, and makes probabilities of their numbers.
fn merged(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let all = points.len() as f64;
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.dedup_by(|later, kept| {
        let is_same = (later.0 - kept.0).abs() < 1e-9;
        if is_same {
            kept.1 += later.1;
        }
        is_same
    });
    points
        .into_iter()
        .map(|(error, n)| (error, n / all))
        .collect()
}
