//! Page's cumulative sums on innovations: residuals of an autoregression learnt before the
//! watch.
//!
//! Two sums for each quadrant of heading find a change of any shape, and found more than
//! sums tuned to steps of (bx, by) in eight directions did. Order and slack are the best of
//! those tried on other ships, 1 to 12 rows and 0.25 to 1 standard deviations.

use crate::score::listen;
use crate::ship::{Ship, spread};
use nalgebra::{DMatrix, DVector};

/// Rows that the autoregression looks back.
const ORDER: usize = 3;
/// Excess of a mean that counts, standard deviations.
const SLACK: f64 = 0.5;
/// Residuals and innovations beyond so many standard deviations count for that many.
const WILD_RESIDUAL: f64 = 5.0;
const WILD: f64 = 2.5;

/// By a threshold in standard deviations of an innovation.
pub(crate) fn alarms(ship: &Ship, threshold: f64) -> Vec<usize> {
    let whitening = Whitening::learn(ship);
    let mut sums = Sums::default();
    listen(
        ship,
        0..ship.rows.len(),
        |row| *row,
        |row, anew| {
            if anew || row == ship.watched {
                sums = Sums::default();
            }
            let innovation = whitening.innovation(ship, row);
            sums.take(ship.rows[row].compass_deg, innovation) > threshold
        },
    )
}

/// Upwards and downwards, for each quadrant.
#[derive(Default)]
pub(crate) struct Sums([[f64; 2]; 4]);

impl Sums {
    /// Reads an innovation in standard deviations, and returns the larger sum of its
    /// quadrant.
    pub(crate) fn take(&mut self, compass_deg: f64, innovation: f64) -> f64 {
        let quadrant = (compass_deg / 90.0) as usize % 4;
        let [up, down] = &mut self.0[quadrant];
        *up = (*up + innovation - SLACK).max(0.0);
        *down = (*down - innovation - SLACK).max(0.0);
        up.max(*down)
    }
}

/// Autoregression of the residuals.
struct Whitening {
    weights: Vec<f64>,
    wild_deg: f64,
    sd_deg: f64,
}

impl Whitening {
    /// By least squares on the rows before the watch.
    fn learn(ship: &Ship) -> Whitening {
        let wild_deg = WILD_RESIDUAL * ship.usual_deg();
        let value = |row: usize| ship.rows[row].residual_deg.clamp(-wild_deg, wild_deg);
        let is_whole = |row: &usize| (row + 1 - ORDER..=*row).all(|row| ship.rows[row].follows);
        let rows: Vec<usize> = (ORDER..ship.watched).filter(is_whole).collect();
        let past = DMatrix::from_fn(rows.len(), ORDER, |i, k| value(rows[i] - 1 - k));
        let now = DVector::from_fn(rows.len(), |i, _| value(rows[i]));
        let normal = (past.transpose() * &past).cholesky();
        let weights = normal.expect("new noise in every row");
        let weights = weights.solve(&(past.transpose() * &now));
        let rest = now - past * &weights;
        Whitening {
            weights: weights.iter().copied().collect(),
            wild_deg,
            sd_deg: spread(rest.iter().copied()),
        }
    }

    /// Returns the innovation in standard deviations; after a pause only by the rows since.
    fn innovation(&self, ship: &Ship, row: usize) -> f64 {
        let value = |row: usize| {
            let residual = ship.rows[row].residual_deg;
            residual.clamp(-self.wild_deg, self.wild_deg)
        };
        let mut rest = value(row);
        for (k, weight) in self.weights.iter().enumerate() {
            if !ship.rows[row - k].follows {
                break;
            }
            rest -= weight * value(row - 1 - k);
        }
        (rest / self.sd_deg).clamp(-WILD, WILD)
    }
}
