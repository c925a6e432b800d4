//! The actual earth's field at the ship: the charted field and its
//! disturbances.
//!
//! The disturbances are the crust (0.2°, correlated over 60 miles), the diurnal
//! variation (0.12°), magnetic storms and local anomalies. They are not part of
//! the truth that a model is compared with: to a compass's user they are noise.

use crate::earth::Chart;
use crate::navigation::rhumb;
use crate::poisson::Field;
use crate::random::Random;
use crate::random::process::Wander;
use crate::scenario::{Anomaly, Scenario, Storm};
use binnacle_compass::field::{self, FieldError};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;

const CRUST_DEG: f64 = 0.2;
const CRUST_NM: f64 = 60.0;
const DAY_DEG: f64 = 0.12;
/// Time over which the field keeps its direction in a storm.
const STORM_S: f64 = 900.0;

#[derive(Clone, Debug)]
pub(crate) struct LocalField {
    start: Timestamp,
    storms: Vec<Storm>,
    anomalies: Vec<Anomaly>,
    crust: Wander,
    storm: Wander,
    random: Random,
    chart: Chart,
    /// Charted variation, for the truth.
    pub(crate) charted: field::Field,
    /// Variation of the needle's north, degrees.
    pub(crate) variation_deg: f64,
    /// Field at the needle.
    pub(crate) field: Field,
}

impl LocalField {
    pub(crate) fn new(
        scenario: &Scenario,
        ship: &str,
        seed: u64,
        start: Timestamp,
        position: Position,
    ) -> Result<LocalField, FieldError> {
        let mut random = Random::new(seed, ship, "surroundings");
        let mut chart = Chart::new(start)?;
        let charted = chart.field(position, start);
        Ok(LocalField {
            start,
            storms: scenario.storms.clone(),
            anomalies: scenario.anomalies.clone(),
            crust: Wander::new(CRUST_DEG, CRUST_NM, &mut random),
            storm: Wander::new(1.0, STORM_S, &mut random),
            random,
            chart,
            charted,
            variation_deg: charted.declination().degrees_east(),
            field: Field {
                h_nt: charted.h_nt(),
                z_nt: charted.z_nt,
            },
        })
    }

    /// Updates the field, once a minute.
    pub(crate) fn step(
        &mut self,
        elapsed_s: f64,
        run_nm: f64,
        position: Position,
        time: Timestamp,
    ) {
        self.charted = self.chart.field(position, time);
        let mut north = self.charted.x_nt;
        let mut east = self.charted.y_nt;
        let mut down = self.charted.z_nt;
        for anomaly in &self.anomalies {
            let distance = rhumb::leg(anomaly.position, position).distance_nm;
            let share = (-(distance / anomaly.radius_nm).powi(2)).exp();
            north += share * anomaly.field_nt[0];
            east += share * anomaly.field_nt[1];
            down += share * anomaly.field_nt[2];
        }
        let storm = self.storm.step(elapsed_s, &mut self.random);
        east += storm * self.storm_nt(time);
        let crust = self.crust.step(run_nm, &mut self.random);
        let noise_deg = crust + DAY_DEG * solar_angle(position, time).sin();
        self.variation_deg = east.atan2(north).to_degrees() + noise_deg;
        self.field = Field {
            h_nt: north.hypot(east),
            z_nt: down,
        };
    }

    /// Storms rise within two hours and fade over their last third.
    fn storm_nt(&self, time: Timestamp) -> f64 {
        let hours = time.seconds_since(self.start) / 3600.0;
        let latitude = self.charted.magnetic_latitude_deg().abs();
        let auroral = 1.0 + 3.0 * (-((latitude - 67.0) / 9.0).powi(2)).exp();
        let strength = |storm: &Storm| {
            let since = hours - storm.day * 24.0;
            if !(0.0..storm.hours).contains(&since) {
                return 0.0;
            }
            let rise = (since / 2.0).min(1.0);
            let fall = ((storm.hours - since) / (storm.hours / 3.0)).min(1.0);
            storm.strength_nt * rise * fall
        };
        auroral * self.storms.iter().map(strength).sum::<f64>()
    }
}

/// Returns the sun's hour angle, radians.
fn solar_angle(position: Position, time: Timestamp) -> f64 {
    let day = time.micros().rem_euclid(86_400_000_000) as f64 / 86_400e6;
    std::f64::consts::TAU * (day + position.lon_deg() / 360.0)
}
