//! Running sums of innovations, from which events are proposed.
//!
//! A jump of a state shows in later innovations by the state's load. Sums of loads and
//! innovations between two rows therefore give the log likelihood ratio of a jump between
//! them, nearly: the filter takes up some of it meanwhile. That is enough to propose an event;
//! it is judged by a filter of its own.

use crate::constants::{LARGEST_SD, WEEK_ROWS, WIDER_COST};
use crate::hypotheses::hypothesis::Read;
use crate::hypotheses::kinds::{Jump, Kind, KindRow};
use crate::state_space::filter::Innovation;
use crate::state_space::row::Row;
use crate::state_space::scalar::{SAYS_NOTHING_DEG, Silent, gyro_share};
use crate::state_space::states::{ALIGNMENT, BX, BY, GYRO, SATELLITE, SETTLING};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// States whose jumps are looked for.
pub(crate) const WATCHED: [usize; 5] = [BX, BY, ALIGNMENT, GYRO, SATELLITE];
/// Cost of a reading that says nothing against a sound one of a quarter of a degree, without what
/// [`WIDER_COST`] has of it: the logarithm of their standard deviations' ratio.
fn any_heading_cost() -> f64 {
    (4.0 * SAYS_NOTHING_DEG).ln() - 0.5 * WIDER_COST
}
const SUMS: usize = WATCHED.len();

/// Sums from the first row on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct EvidenceSums {
    information: [[f64; SUMS]; SUMS],
    score: [f64; SUMS],
    /// Squares of innovations beyond what is usual.
    excess: f64,
    /// Log Bayes factors of a card that shows any heading, and of such a reference, nearly.
    any_heading: [f64; 2],
    /// Usual square of an innovation; none before the first.
    usual: Option<f64>,
}

impl EvidenceSums {
    /// Adds a row that was read.
    pub(crate) fn add(&mut self, row: &Row, read: &Read) {
        let [gyro, satellite] = if row.course.is_some() {
            [0.0; 2]
        } else {
            let gyro = gyro_share(row, Silent::default());
            [gyro, 1.0 - gyro]
        };
        let load = &read.load.load;
        let main = [load[BX], load[BY], 1.0, gyro, satellite];
        let of_card = self.add_scalar(&main, read.deviation);
        let of_reference = match read.difference {
            Some(difference) => self.add_scalar(&[0.0, 0.0, 0.0, 1.0, -1.0], difference),
            None => of_card,
        };
        self.any_heading[0] += of_card;
        self.any_heading[1] += of_reference;
    }

    /// Adds an innovation. Returns by how much it is likelier of an instrument that shows any
    /// heading.
    fn add_scalar(&mut self, load: &[f64; SUMS], innovation: Innovation) -> f64 {
        let z_squared = innovation.z_squared();
        let capped = (LARGEST_SD * LARGEST_SD / z_squared).sqrt().min(1.0);
        let weight = 1.0 / innovation.variance;
        for i in 0..SUMS {
            self.score[i] += load[i] * innovation.value * capped * weight;
            for j in 0..SUMS {
                self.information[i][j] += load[i] * load[j] * weight;
            }
        }
        let square = z_squared.min(0.5 * LARGEST_SD * LARGEST_SD);
        let usual = self.usual.unwrap_or(1.0);
        self.usual = Some(usual + (square - usual) / (2 * WEEK_ROWS) as f64);
        let excess = square - usual - WIDER_COST;
        self.excess += excess;
        0.5 * excess - any_heading_cost()
    }

    /// Returns the sums since an earlier time.
    pub(crate) fn since(&self, earlier: &EvidenceSums) -> EvidenceSums {
        let mut sums = *self;
        for i in 0..SUMS {
            sums.score[i] -= earlier.score[i];
            for j in 0..SUMS {
                sums.information[i][j] -= earlier.information[i][j];
            }
        }
        sums.excess -= earlier.excess;
        for (sum, earlier) in sums.any_heading.iter_mut().zip(earlier.any_heading) {
            *sum -= earlier;
        }
        sums
    }

    /// Returns the greatest log likelihood ratio of a jump of any size: of any one state, or of
    /// (bx, by), which may not show on the heading after it.
    pub(crate) fn greatest(&self) -> f64 {
        let of = |i: usize| {
            let information = self.information[i][i];
            if information > 0.0 {
                0.5 * self.score[i] * self.score[i] / information
            } else {
                0.0
            }
        };
        let [[xx, xy], [_, yy]] = [0, 1].map(|i| [0, 1].map(|j| self.information[i][j]));
        let [x, y] = [self.score[0], self.score[1]];
        let determinant = xx * yy - xy * xy;
        let both = if determinant > 1e-9 * xx * yy {
            0.5 * (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant
        } else {
            0.0
        };
        (0..SUMS).map(of).fold(both, f64::max)
    }

    /// Returns empty sums that know the usual square.
    pub(crate) fn restarted(&self) -> EvidenceSums {
        EvidenceSums {
            usual: self.usual,
            ..EvidenceSums::default()
        }
    }

    /// Returns the squares beyond the usual.
    pub(crate) fn excess(&self) -> f64 {
        self.excess
    }

    /// Returns the logarithm of the Bayes factor of an instrument that shows any heading against
    /// a sound one, nearly.
    pub(crate) fn log_factor_of_any_heading(&self, kind: Kind) -> f64 {
        self.any_heading[usize::from(kind != Kind::FailedCard)]
    }

    /// Returns the logarithm of the Bayes factor of a kind's jump against none.
    pub(crate) fn log_bayes_factor(&self, kind: &KindRow) -> f64 {
        let watched: Vec<(usize, f64)> = kind.jumps.iter().filter_map(watched).collect();
        let n = watched.len();
        if n == 0 {
            return 0.0;
        }
        let information = DMatrix::from_fn(n, n, |a, b| {
            self.information[watched[a].0][watched[b].0] * watched[a].1 * watched[b].1
                + f64::from(u8::from(a == b))
        });
        let score = DVector::from_fn(n, |a, _| self.score[watched[a].0] * watched[a].1);
        let Some(factor) = information.cholesky() else {
            return 0.0;
        };
        let log_determinant: f64 = factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum();
        0.5 * score.dot(&factor.solve(&score)) - log_determinant
    }
}

/// Returns the place of a jump's state among the sums, with its standard deviation.
fn watched(jump: &Jump) -> Option<(usize, f64)> {
    let state = if jump.state == SETTLING {
        GYRO
    } else {
        jump.state
    };
    let place = WATCHED.iter().position(|watched| *watched == state)?;
    Some((place, jump.sd))
}
