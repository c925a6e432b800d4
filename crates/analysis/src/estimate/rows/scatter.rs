//! How much white noise a row has: by the windows that it is of, and by how far they
//! scattered.
//!
//! In a sea the card swings about the mean, and the scatter of compass less reference
//! says by how much. What scatters in the windows stands in their mean, the less the
//! more of them there are: as a multiple of the ship's own white noise, and by so much
//! at the least whatever that is taken for, as where it hides in slower noise.

use crate::observation::Observation;

/// Windows of ten seconds in ten minutes.
const FULL_WINDOWS: f64 = 60.0;
/// A row with fewer was interrupted, and what interrupted it upset it beside: its
/// variance is so many times what its windows alone would make it.
const WHOLE_WINDOWS: f64 = 57.0;
const INTERRUPTED: f64 = 1.5;
/// The scatter in a full mean whose factor is 1, degrees.
const NOMINAL_DEG: f64 = 0.5;
/// As much as so many windows, a row's scatter is taken for the ship's usual one.
const SHRINKING_WINDOWS: f64 = 8.0;
/// And at the start the ship's usual one for the nominal.
const STARTING_WINDOWS: f64 = 600.0;
/// White noise that is none of the sea's: roundings, sensors.
const CALM: f64 = 0.1;
/// What scatters keeps its sign for so many windows at the least.
const OF_ONE_SIGN: f64 = 2.0;
/// No more is believed, degrees.
const LARGEST_DEG: f64 = 3.0;

/// White variance, degrees squared, by the ship's level.
#[derive(Clone, Copy, Debug)]
pub(crate) struct White {
    /// In units of a full, unit-weight row's at nominal scatter.
    pub(crate) factor: f64,
    /// What the scatter alone explains.
    pub(crate) scatter: f64,
}

impl White {
    /// At a level squared.
    pub(crate) fn variance(self, level_squared: f64) -> f64 {
        level_squared * self.factor + self.scatter
    }

    /// Of the difference of both references, in which the card has no part.
    pub(crate) fn of_difference(o: &Observation) -> White {
        White {
            factor: (1.0 + FULL_WINDOWS / windows(o)) / (2.0 * o.weight),
            scatter: 0.0,
        }
    }
}

/// The scatter of a ship's windows so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scatter {
    /// Sum of squares over windows, degrees squared.
    squares: f64,
    windows: f64,
}

impl Scatter {
    pub(crate) fn new() -> Scatter {
        Scatter {
            squares: STARTING_WINDOWS * NOMINAL_DEG * NOMINAL_DEG,
            windows: STARTING_WINDOWS,
        }
    }

    /// Of the row's deviation; takes the row in.
    pub(crate) fn white(&mut self, o: &Observation) -> White {
        let windows = windows(o);
        let usual = self.squares / self.windows;
        let (square, told) = match o.spread_deg {
            Some(spread_deg) => {
                let own = spread_deg.clamp(0.0, LARGEST_DEG).powi(2);
                self.squares += windows * own;
                self.windows += windows;
                let square =
                    (SHRINKING_WINDOWS * usual + windows * own) / (SHRINKING_WINDOWS + windows);
                (square, square)
            }
            None => (usual, 0.0),
        };
        let sea = square / (NOMINAL_DEG * NOMINAL_DEG);
        White {
            factor: (CALM + (1.0 - CALM) * sea * of_windows(windows)) / o.weight,
            scatter: OF_ONE_SIGN * told / windows / o.weight,
        }
    }
}

fn windows(o: &Observation) -> f64 {
    f64::from(o.windows).clamp(1.0, FULL_WINDOWS)
}

/// Variance of a mean of so many windows in units of a full one's.
fn of_windows(windows: f64) -> f64 {
    let upset = if windows < WHOLE_WINDOWS {
        INTERRUPTED
    } else {
        1.0
    };
    upset * FULL_WINDOWS / windows
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::angle::{CompassHeading, Deviation, Variation};

    fn row(windows: u16, spread_deg: Option<f64>) -> Observation {
        Observation {
            time: None,
            position: None,
            compass: CompassHeading::new(90.0).unwrap(),
            deviation: Deviation::ZERO,
            variation: Variation::ZERO,
            h_nt: 20_000.0,
            z_nt: 40_000.0,
            gyro_share: 1.0,
            gyro_less_satellite_deg: None,
            sog_kn: None,
            windows,
            spread_deg,
            weight: 1.0,
        }
    }

    fn factor(windows: u16, spread_deg: Option<f64>) -> f64 {
        Scatter::new().white(&row(windows, spread_deg)).factor
    }

    #[test]
    fn a_full_row_of_nominal_scatter_counts_once() {
        assert!((factor(60, Some(0.5)) - 1.0).abs() < 1e-12);
        assert!((factor(60, None) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn twice_the_scatter_is_near_four_times_the_variance() {
        let ratio = factor(60, Some(1.0)) / factor(60, Some(0.5));
        assert!((3.0..4.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn fewer_windows_are_more_noise_and_their_own_scatter_says_less() {
        assert!(factor(6, None) > 10.0 * factor(60, None));
        let by_scatter = |windows| factor(windows, Some(1.0)) / factor(windows, Some(0.5));
        assert!(by_scatter(3) < by_scatter(30));
    }

    #[test]
    fn a_row_that_does_not_say_has_the_usual_scatter_of_the_ship_so_far() {
        let mut scatter = Scatter::new();
        for _ in 0..500 {
            scatter.white(&row(60, Some(1.0)));
        }
        let usual = scatter.white(&row(60, None)).factor;
        assert!((3.4..3.8).contains(&usual), "{usual}");
    }

    #[test]
    fn nothing_that_a_row_may_say_makes_it_worth_nothing() {
        for spread_deg in [0.0, 1e300] {
            let factor = factor(1, Some(spread_deg));
            assert!(factor > 0.0 && factor < 1e4, "{factor}");
        }
    }
}
