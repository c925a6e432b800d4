//! Starting guesses of a ship that nothing is known of.

use super::hypothesis::Hypothesis;
use crate::state_space::filter::Filter;
use crate::state_space::levels::{Level, Levels};
use crate::state_space::row::Row;
use crate::state_space::scalar::{Silent, deviation};
use crate::state_space::states::{
    ALIGNMENT, CRAB, CURRENT, DAILY, FRICTION, GYRO, GYRO_HEADING, GYRO_SLOW, HEEL, LAG, LEEWAY,
    LIST, LIST_NT, REFLECTION, RETENTION, SATELLITE, SCHULER, SPEED, STATES, STEADY, SWING,
    VARIATION,
};
use crate::state_space::transition::STEADY_KN;
use binnacle_analysis::estimate::POPULATION_SD;
use binnacle_analysis::fleet_prior::{PriorComponent, ShipPrior};

/// Guess of a value: standard deviation and probability.
#[derive(Clone, Copy, Debug)]
struct Guess {
    size: f64,
    probability: f64,
}

const fn guess(size: f64, probability: f64) -> Guess {
    Guess { size, probability }
}

/// Guesses of where the compass's zero is: standard deviation in degrees. The last is about
/// where the first row has it.
const ALIGNMENTS: [Guess; 3] = [guess(0.6, 0.80), guess(4.0, 0.17), guess(8.0, 0.03)];
/// Guesses of the ship's size over that of the prior.
const SIZES: [Guess; 2] = [guess(1.0, 0.85), guess(2.5, 0.15)];
/// Guesses of the gyro's speed error that is left in the reading.
const SPEED_ERRORS: [Guess; 2] = [guess(0.0, 0.85), guess(1.0, 0.15)];

/// Guesses of how large the references' constants are, over their usual size. Two of them have
/// heavier tails than one: a constant of 0.75° sec φ is allowed [IMO A.424(XI)].
const CONSTANTS: [Guess; 2] = [guess(1.0, 0.85), guess(2.0, 0.15)];

/// Guesses of the habit that a ship has much more than others: her magnetism drifts, or jumps
/// a little at each call.
const HABITS: [(Option<Level>, f64); 3] = [
    (None, 0.8),
    (Some(Level::Drift), 0.1),
    (Some(Level::PortStep), 0.1),
];
/// Constant drift angle of a usual ship, degrees.
pub(crate) const CRAB_DEG: f64 = 1.0;

/// Returns the starting hypotheses: each guess with each other, for each component of what is
/// known of ships like her.
pub(crate) fn starts(
    row: &Row,
    levels: &Levels,
    reference_sd_deg: f64,
    prior: &ShipPrior,
) -> Vec<Hypothesis> {
    let plain = if row.course.is_some() {
        drifting(levels, reference_sd_deg)
    } else {
        instruments(levels, reference_sd_deg / row.cos_lat.max(0.3))
    };
    let mut starts: Vec<Hypothesis> = Vec::new();
    for component in &prior.components {
        for (size, speed, constant) in guesses_of_instruments(row) {
            let mut filter = of_component(component, size.size, &plain);
            if row.gyro_deg.is_some() {
                filter.mean[SPEED] = speed.size;
            }
            for state in [GYRO, SATELLITE] {
                filter.covariance[state][state] *= constant.size.powi(2);
            }
            let probability =
                component.weight * size.probability * speed.probability * constant.probability;
            for (nth, alignment) in ALIGNMENTS.into_iter().enumerate() {
                let is_last = nth + 1 == ALIGNMENTS.len();
                let filter =
                    with_alignment(&filter, alignment.size, is_last.then_some(row), levels);
                for (lively, share) in HABITS {
                    let probability = probability * alignment.probability * share;
                    starts.push(Hypothesis {
                        filter: filter.clone(),
                        events: Vec::new(),
                        log_prior: probability.ln(),
                        start: starts.len(),
                        lively,
                        wild: None,
                        amid: None,
                    });
                }
            }
        }
    }
    starts
}

/// Returns each guess of the ship's size with each of the speed error and of the constants, as far
/// as a ship has the instruments.
fn guesses_of_instruments(row: &Row) -> impl Iterator<Item = (Guess, Guess, Guess)> {
    let speeds = if row.gyro_deg.is_some() { 2 } else { 1 };
    let constants = if row.course.is_none() { 2 } else { 1 };
    SIZES.into_iter().flat_map(move |size| {
        SPEED_ERRORS
            .into_iter()
            .take(speeds)
            .flat_map(move |speed| {
                let constants = CONSTANTS.into_iter().take(constants);
                constants.map(move |constant| (size, speed, constant))
            })
    })
}

/// Returns a filter before the first row, its ship drawn from a component of the prior.
fn of_component(component: &PriorComponent, size: f64, plain: &[f64; STATES]) -> Filter {
    let mut filter = Filter::new(&[0.0; STATES], plain);
    let rows = component.covariance.iter().zip(POPULATION_SD).enumerate();
    for (i, (row, sd)) in rows {
        filter.mean[i] = component.mean[i] / sd;
        for (j, (covariance, other_sd)) in row.iter().zip(POPULATION_SD).enumerate() {
            filter.covariance[i][j] = size * size * covariance / (sd * other_sd);
        }
    }
    filter
}

/// Returns the filter with a guess of the alignment: about zero, or about where a row has it.
fn with_alignment(filter: &Filter, sd_deg: f64, at: Option<&Row>, levels: &Levels) -> Filter {
    let mut filter = filter.clone();
    filter.covariance[ALIGNMENT][ALIGNMENT] = sd_deg * sd_deg;
    if let Some(row) = at {
        filter.mean[ALIGNMENT] = deviation(row, &filter.mean, levels, Silent::default()).innovation;
    }
    filter
}

/// Returns the standard deviations of a ship with gyro or satellite compass.
fn instruments(levels: &Levels, reference_sd_deg: f64) -> [f64; STATES] {
    let mut sd = common(levels);
    sd[GYRO] = reference_sd_deg;
    sd[GYRO_SLOW] = levels.at(Level::GyroSlow);
    sd[SCHULER] = levels.at(Level::Schuler);
    sd[SCHULER + 1] = levels.at(Level::Schuler);
    sd[SPEED] = 0.1;
    sd[GYRO_HEADING] = 0.15;
    sd[GYRO_HEADING + 1] = 0.15;
    sd[SATELLITE] = reference_sd_deg;
    sd[REFLECTION] = levels.at(Level::Reflection);
    sd[LAG] = 0.03;
    sd
}

/// Returns the standard deviations of a ship that has a course over ground alone.
fn drifting(levels: &Levels, reference_sd_deg: f64) -> [f64; STATES] {
    let mut sd = common(levels);
    sd[CRAB] = CRAB_DEG.hypot(reference_sd_deg);
    for part in 0..2 {
        sd[CURRENT + 2 * part] = levels.at(Level::Current);
        sd[CURRENT + 2 * part + 1] = 3.0_f64.sqrt() * levels.at(Level::Current);
        sd[LEEWAY + part] = levels.at(Level::Leeway);
        sd[STEADY + part] = STEADY_KN;
    }
    sd
}

fn common(levels: &Levels) -> [f64; STATES] {
    let mut sd = [0.0; STATES];
    sd[RETENTION] = 1.0;
    sd[RETENTION + 1] = 1.0;
    sd[HEEL] = 1.0;
    sd[LIST] = levels.at(Level::List) / LIST_NT;
    sd[SWING] = levels.at(Level::Swing);
    sd[FRICTION] = levels.at(Level::Friction);
    sd[VARIATION] = levels.at(Level::Variation);
    sd[DAILY] = 0.1;
    sd[DAILY + 1] = 0.1;
    sd
}
