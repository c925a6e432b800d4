//! White noise of a row, by its number of windows and their scatter.
//!
//! In a sea the card swings about the mean, and the scatter of compass less reference shows
//! by how much. The scatter of the windows is in their mean, the less the more windows
//! there are. It counts as a multiple of the vessel's own white noise, and with at least
//! its own size, in case that noise is taken for slower noise.

use crate::observation::Observation;
use serde::{Deserialize, Serialize};

/// Windows of ten seconds in ten minutes.
const FULL_WINDOWS: f64 = 60.0;
/// Number of windows below which a row was interrupted, and the factor on its variance:
/// what interrupted it disturbed it, too.
const WHOLE_WINDOWS: f64 = 57.0;
const INTERRUPTED_FACTOR: f64 = 1.5;
/// Scatter of a full mean whose factor is 1, degrees.
const NOMINAL_DEG: f64 = 0.5;
/// Weight of the vessel's usual scatter beside a row's own, in windows.
const SHRINKING_WINDOWS: f64 = 8.0;
/// Windows by which the scatter of late is known.
const RECENT_WINDOWS: f64 = 300.0;
/// Weight of the nominal scatter beside the vessel's at the start, in windows.
const STARTING_WINDOWS: f64 = 600.0;
/// Share of white noise that the sea does not cause: rounding, sensors.
const SEALESS_SHARE: f64 = 0.1;
/// Least number of windows for which a scatter keeps its sign.
const WINDOWS_OF_ONE_SIGN: f64 = 2.0;
/// Largest scatter that counts, degrees.
const LARGEST_DEG: f64 = 3.0;

/// White variance of a row, by the vessel's level.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct WhiteNoise {
    /// Factor on the level's square: 1 for a full row of unit weight at nominal scatter.
    pub factor: f64,
    /// Variance that the scatter alone explains, degrees squared.
    pub scatter: f64,
}

impl WhiteNoise {
    /// Returns the variance at a squared level.
    pub fn variance(self, level_squared: f64) -> f64 {
        level_squared * self.factor + self.scatter
    }

    /// Returns the white noise of the references' difference, in which the card has no
    /// part.
    pub fn of_difference(o: &Observation) -> WhiteNoise {
        WhiteNoise {
            factor: (1.0 + FULL_WINDOWS / windows(o)) / (2.0 * o.weight),
            scatter: 0.0,
        }
    }
}

/// Scatter of a vessel's windows so far.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Scatter {
    /// Sum of squares over windows, degrees squared.
    squares: f64,
    windows: f64,
    /// Mean square of late, weighed by the windows.
    recent: f64,
}

impl Default for Scatter {
    /// Returns the scatter of a vessel that nothing is known of.
    fn default() -> Scatter {
        Scatter {
            squares: STARTING_WINDOWS * NOMINAL_DEG * NOMINAL_DEG,
            windows: STARTING_WINDOWS,
            recent: NOMINAL_DEG * NOMINAL_DEG,
        }
    }
}

impl Scatter {
    /// Returns the scatter of late over the usual: the sea.
    pub fn sea(&self) -> f64 {
        (self.recent * self.windows / self.squares).sqrt()
    }

    /// Returns the white noise of a row's deviation, and adds the row.
    pub fn white(&mut self, o: &Observation) -> WhiteNoise {
        let windows = windows(o);
        let usual = self.squares / self.windows;
        let (square, shown) = match o.spread_deg {
            Some(spread_deg) => {
                let own = spread_deg.clamp(0.0, LARGEST_DEG).powi(2);
                self.squares += windows * own;
                self.windows += windows;
                self.recent += (own - self.recent) * windows / (RECENT_WINDOWS + windows);
                let square = (SHRINKING_WINDOWS * self.recent + windows * own)
                    / (SHRINKING_WINDOWS + windows);
                (square, square)
            }
            None => (usual, 0.0),
        };
        let sea = square / (NOMINAL_DEG * NOMINAL_DEG);
        WhiteNoise {
            factor: (SEALESS_SHARE + (1.0 - SEALESS_SHARE) * sea * mean_variance_factor(windows))
                / o.weight,
            scatter: WINDOWS_OF_ONE_SIGN * shown / windows / o.weight,
        }
    }
}

fn windows(o: &Observation) -> f64 {
    f64::from(o.windows).clamp(1.0, FULL_WINDOWS)
}

/// Returns the variance of a mean of some windows, relative to a full mean's.
fn mean_variance_factor(windows: f64) -> f64 {
    let interruption = if windows < WHOLE_WINDOWS {
        INTERRUPTED_FACTOR
    } else {
        1.0
    };
    interruption * FULL_WINDOWS / windows
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
        Scatter::default().white(&row(windows, spread_deg)).factor
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
        let mut scatter = Scatter::default();
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
