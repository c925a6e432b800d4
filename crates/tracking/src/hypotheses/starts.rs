//! Starting guesses of a ship that nothing is known of.

use super::hypothesis::Hypothesis;
use crate::state_space::filter::Filter;
use crate::state_space::levels::{Level, Levels};
use crate::state_space::row::Row;
use crate::state_space::scalar::{Silent, deviation};
use crate::state_space::states::{
    ALIGNMENT, DAILY, FRICTION, GYRO, GYRO_HEADING, GYRO_SLOW, HEEL, LAG, LIST, LIST_NT,
    REFLECTION, RETENTION, SATELLITE, SCHULER, SPEED, STATES, SWING, VARIATION,
};
use binnacle_compass::ship::PARAMETERS;

/// Guess of where the compass's zero is: standard deviation, degrees, and probability. The
/// last guess is where the first row has it.
const ALIGNMENTS: [(f64, f64); 3] = [(0.6, 0.80), (4.0, 0.17), (8.0, 0.03)];
/// Guess of the ship's size over the population's, and probability.
const SIZES: [(f64, f64); 2] = [(1.0, 0.85), (2.5, 0.15)];
/// Guess of the gyro's speed error left in the reading, and probability.
const SPEED_ERRORS: [(f64, f64); 2] = [(0.0, 0.85), (1.0, 0.15)];

/// Returns the starting hypotheses.
pub(crate) fn starts(row: &Row, levels: &Levels, reference_sd_deg: f64) -> Vec<Hypothesis> {
    let mut starts = Vec::new();
    for (guess, (alignment_sd, by_alignment)) in ALIGNMENTS.into_iter().enumerate() {
        for (size, by_size) in SIZES {
            for (speed, by_speed) in SPEED_ERRORS {
                if row.gyro_deg.is_none() && speed != 0.0 {
                    continue;
                }
                let mut mean = [0.0; STATES];
                let mut sd = deviations(levels, reference_sd_deg / row.cos_lat.max(0.3));
                for sd in &mut sd[..PARAMETERS] {
                    *sd *= size;
                }
                mean[SPEED] = speed;
                sd[ALIGNMENT] = alignment_sd;
                if guess + 1 == ALIGNMENTS.len() {
                    mean[ALIGNMENT] = deviation(row, &mean, levels, Silent::default()).innovation;
                }
                starts.push(Hypothesis {
                    filter: Filter::new(mean, &sd),
                    events: Vec::new(),
                    log_prior: f64::ln(by_alignment * by_size * by_speed),
                    start: starts.len(),
                    wild: None,
                    is_amid: false,
                });
            }
        }
    }
    starts
}

fn deviations(levels: &Levels, reference_sd_deg: f64) -> [f64; STATES] {
    let mut sd = [0.0; STATES];
    sd[..PARAMETERS].fill(1.0);
    sd[RETENTION] = 0.7;
    sd[RETENTION + 1] = 0.7;
    sd[HEEL] = 1.0;
    sd[LIST] = levels.at(Level::List) / LIST_NT;
    sd[SWING] = levels.at(Level::Swing);
    sd[FRICTION] = levels.at(Level::Friction);
    sd[VARIATION] = levels.at(Level::Variation);
    sd[DAILY] = 0.1;
    sd[DAILY + 1] = 0.1;
    sd[GYRO] = reference_sd_deg;
    sd[GYRO_SLOW] = levels.at(Level::GyroSlow);
    sd[SCHULER] = levels.at(Level::Schuler);
    sd[SCHULER + 1] = levels.at(Level::Schuler);
    sd[SPEED] = 0.1;
    sd[GYRO_HEADING] = 0.1;
    sd[GYRO_HEADING + 1] = 0.1;
    sd[SATELLITE] = reference_sd_deg;
    sd[REFLECTION] = levels.at(Level::Reflection);
    sd[LAG] = 0.03;
    sd
}
