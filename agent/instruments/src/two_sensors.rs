//! Two sensors that read differently behind one source, as a multiplexer mixes them.
//!
//! A single sensor's readings scatter about the ship's motion. Two sensors make the readings jump
//! to and fro by the same angle: each is near one of the two readings before it, while jumps of
//! one size and of alternating sign lie between them.

use binnacle_compass::angle::wrap_180;
use std::collections::VecDeque;

/// Latest readings that are compared.
const READINGS: usize = 64;
/// Readings after which they are compared again.
const EVERY: usize = 8;
/// Smallest difference that is noticed, degrees: a third of one that alternates on real ships.
const LEAST_DEG: f64 = 0.5;
/// Smallest difference in digits of the readings: a rounded heading flickers by one.
const LEAST_DIGITS: f64 = 1.5;
/// Smallest difference in units of the scatter about either of the two readings before: for
/// Gaussian noise 3.9 standard deviations of one difference, exceeded by one in ten thousand.
const LEAST_SCATTERS: f64 = 10.0;
/// Least number of jumps: five single readings that are off, to and fro. By chance there are as
/// many in less than one of a billion sets of readings.
const JUMPS: usize = 10;
/// Standard deviations by which each half of the readings must alternate: by chance one of ten
/// million halves does.
const ALTERNATION_SD: f64 = 5.0;
/// Standard error of the mean in units of that of independent values: of white noise the differences
/// from the neighbours have 1.22 standard deviations, and their signed sum that of 2.
const ALTERNATION_ERROR: f64 = 1.64;
/// Greatest spread of the jumps, as a share of their mean.
const SPREAD: f64 = 0.25;

/// Detector for the headings of one source.
#[derive(Debug, Default)]
pub(super) struct TwoSensors {
    readings: VecDeque<f64>,
    since_compared: usize,
    difference_deg: Option<f64>,
}

impl TwoSensors {
    /// Applies a heading in degrees. Returns the difference of two sensors, if there are two.
    pub(super) fn observe(&mut self, heading_deg: f64) -> Option<f64> {
        if self.readings.len() == READINGS {
            self.readings.pop_front();
        }
        self.readings.push_back(heading_deg);
        self.since_compared += 1;
        if self.since_compared >= EVERY {
            self.since_compared = 0;
            self.difference_deg = self.compare();
        }
        self.difference_deg
    }

    /// Returns the difference that was found last.
    pub(super) fn difference_deg(&self) -> Option<f64> {
        self.difference_deg
    }

    fn compare(&self) -> Option<f64> {
        if self.readings.len() < READINGS {
            return None;
        }
        self.alternation().or_else(|| self.jumps())
    }

    /// Returns the difference of sensors that take turns, however the ship yaws.
    ///
    /// Each reading is compared with the middle of its neighbours, every other one with the
    /// opposite sign: motion cancels out, and what remains is the difference.
    fn alternation(&self) -> Option<f64> {
        let least_deg = LEAST_DEG.max(LEAST_DIGITS * self.digit_deg());
        let at = |place: usize| self.readings[place];
        let signed = |place: usize| {
            let before = wrap_180(at(place) - at(place - 1));
            let after = wrap_180(at(place) - at(place + 1));
            let sign = if place.is_multiple_of(2) { 0.5 } else { -0.5 };
            sign * (before + after)
        };
        let half = |places: std::ops::Range<usize>| {
            let count = places.len() as f64;
            let values: Vec<f64> = places.map(signed).collect();
            let mean = values.iter().sum::<f64>() / count;
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
            let error = ALTERNATION_ERROR * (variance / count).sqrt();
            (mean.abs() >= ALTERNATION_SD * error).then_some(mean)
        };
        let (first, second) = (half(1..READINGS / 2)?, half(READINGS / 2..READINGS - 1)?);
        let difference = f64::midpoint(first, second);
        (first * second > 0.0 && difference.abs() >= least_deg).then_some(difference.abs())
    }

    /// Returns the difference of sensors of which one is read more often.
    fn jumps(&self) -> Option<f64> {
        let at = |place: usize| self.readings[place];
        let steps: Vec<f64> = (2..READINGS)
            .map(|place| wrap_180(at(place) - at(place - 1)))
            .collect();
        let mut scatter: Vec<f64> = (2..READINGS)
            .zip(&steps)
            .map(|(place, step)| step.abs().min(wrap_180(at(place) - at(place - 2)).abs()))
            .collect();
        scatter.sort_by(f64::total_cmp);
        let scatter_deg = scatter[scatter.len() / 2];
        let least_deg = LEAST_DEG
            .max(LEAST_DIGITS * self.digit_deg())
            .max(LEAST_SCATTERS * scatter_deg);
        let jumps: Vec<f64> = steps
            .into_iter()
            .filter(|step| step.abs() >= least_deg)
            .collect();
        if jumps.len() < JUMPS || jumps.windows(2).any(|pair| pair[0] * pair[1] > 0.0) {
            return None;
        }
        let count = jumps.len() as f64;
        let mean = jumps.iter().map(|jump| jump.abs()).sum::<f64>() / count;
        let variance = jumps
            .iter()
            .map(|jump| (jump.abs() - mean).powi(2))
            .sum::<f64>()
            / count;
        (variance.sqrt() <= SPREAD * mean).then_some(mean)
    }

    /// Returns the digit of the readings, degrees: 1, ½, a tenth, or none.
    fn digit_deg(&self) -> f64 {
        let lie_on = |digit: f64| {
            self.readings
                .iter()
                .all(|reading| (reading / digit - (reading / digit).round()).abs() < 1e-6)
        };
        [1.0, 0.5, 0.1]
            .into_iter()
            .find(|digit| lie_on(*digit))
            .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};

    fn noise(rng: &mut StdRng) -> f64 {
        // A sum of twelve even numbers has the variance 1.
        (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
    }

    fn rounded(degrees: f64, digit: f64) -> f64 {
        (degrees / digit).round() * digit
    }

    /// Yaw of a ship in a seaway while turning now and then.
    fn ship(second: f64) -> f64 {
        350.0 + 3.0 * (second / 1.3).sin() + 40.0 * (second / 200.0).sin()
    }

    #[test]
    fn two_sensors_that_alternate_are_noticed_by_their_difference() {
        for (share, digit) in [(2, 0.01), (2, 0.1), (5, 0.1), (3, 0.1)] {
            let mut rng = StdRng::seed_from_u64(7);
            let mut detector = TwoSensors::default();
            let mut found = None;
            for reading in 0..200 {
                let second = f64::from(reading) / 20.0;
                let off = if reading % share == 0 { 1.52 } else { 0.0 };
                let heading = 205.0 + second / 10.0 + off + 0.03 * noise(&mut rng);
                found = detector.observe(rounded(heading, digit).rem_euclid(360.0));
            }
            let found = found.unwrap_or_default();
            assert!((found - 1.52).abs() < 0.1, "{share} {digit}: {found}");
        }
    }

    #[test]
    fn they_are_noticed_while_the_ship_yaws() {
        let mut rng = StdRng::seed_from_u64(3);
        let mut detector = TwoSensors::default();
        let found = (0..400).filter_map(|reading| {
            let off = if reading % 2 == 0 { 1.5 } else { 0.0 };
            let heading = ship(f64::from(reading / 2)) + off + 0.2 * noise(&mut rng);
            detector.observe(rounded(heading, 0.1).rem_euclid(360.0))
        });
        let found: Vec<f64> = found.collect();
        assert!(found.len() > 100, "{}", found.len());
        assert!(
            found.iter().all(|found| (found - 1.5).abs() < 0.5),
            "{found:?}"
        );
    }

    #[test]
    fn they_are_noticed_across_north() {
        let mut detector = TwoSensors::default();
        let found = (0..100)
            .filter_map(|reading| detector.observe(if reading % 2 == 0 { 359.5 } else { 1.0 }));
        assert_eq!(found.last(), Some(1.5));
    }

    #[test]
    fn one_sensor_is_one_whatever_the_ship_does() {
        let mut alarms = 0;
        for seed in 0..60 {
            let mut rng = StdRng::seed_from_u64(seed);
            let noise_deg = [0.0, 0.05, 0.3, 1.5][seed as usize % 4];
            let digit = [0.01, 0.1, 0.5, 1.0, 1.0][seed as usize % 5];
            let rate_hz = [1.0, 10.0, 0.9][seed as usize % 3];
            let mut detector = TwoSensors::default();
            for reading in 0..20_000 {
                let second = f64::from(reading) / rate_hz;
                // One reading in a thousand is wild.
                let wild = if rng.random::<f64>() < 1e-3 {
                    20.0
                } else {
                    0.0
                };
                let heading = ship(second) + noise_deg * noise(&mut rng) + wild;
                let shown = rounded(heading, digit).rem_euclid(360.0);
                alarms += u32::from(detector.observe(shown).is_some());
            }
        }
        assert_eq!(alarms, 0);
    }
}
