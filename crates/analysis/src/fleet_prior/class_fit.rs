//! Mean and spread of a class, by Bayes' rule.
//!
//! All in units of the population's standard deviations. The population's
//! variance is that of the classes' means and of the vessels within a class together, so a
//! class about which nothing is known yet is the population. The spread of each ratio has a
//! grid of values, each weighted by its likelihood with the mean integrated out, the other
//! spreads standing at their expectations; a few rounds settle them. Each vessel counts by
//! the probability that it belongs to the class at all.

use super::evidence::{Likelihood, ShipEvidence};
use super::{Matrix, Vector};
use binnacle_compass::ship::PARAMETERS;

/// Least and greatest spread of a class, in units of the population's. No class is so alike
/// that two measurements of it would be one ship's; a class of unlike ships about a mean of
/// its own may spread a little beyond the population.
const SPREAD_RANGE: [f64; 2] = [0.05, 1.25];
/// Values of the spread: a step of a fourth, as well as twenty vessels know it.
const SPREADS: usize = 16;

/// Least variance of the mean of classes, in units of the population's: a class of unlike
/// ships may still have a mean of its own.
const LEAST_MEAN_VARIANCE: f64 = 0.2;

/// Vessels like and unlike their class that experience is worth before any is known: one in
/// ten is unlike.
const LIKE_BEFORE: f64 = 9.0;
const UNLIKE_BEFORE: f64 = 1.0;

/// Part of a class's probability that a newcomer begins with. A short voyage cannot tell a
/// ship unlike the class from one like it, and a band too narrow is worse than one too wide: the
/// value was chosen by Monte Carlo, so that a ship at large keeps 93 % (docs/science.md, §13).
const NEWCOMER_SHARE: f64 = 0.2;

/// Rounds after which spreads and memberships no longer move by 1 %.
const ROUNDS: usize = 8;

/// Distribution of a new vessel of the class.
pub(super) struct ClassFit {
    /// Probability with which a newcomer begins as one of the class.
    pub(super) weight: f64,
    /// Mean of a vessel that is.
    pub(super) mean: Vector,
    /// Covariance of such a vessel: the class's spread, and the uncertainty of mean and
    /// spread.
    pub(super) covariance: Matrix,
}

/// Returns the distribution of a new vessel from the evidence of others.
pub(super) fn fit(ships: &[ShipEvidence]) -> ClassFit {
    let mut state = State {
        ships: ships.iter().map(ShipEvidence::likelihood).collect(),
        membership: vec![1.0; ships.len()],
        spreads: [[1.0 / SPREADS as f64; SPREADS]; PARAMETERS],
        variance: Vector::from_element(0.25),
    };
    for _ in 0..ROUNDS {
        for j in 0..PARAMETERS {
            let spread = state.spread_of(j);
            state.variance[j] = spread.expected_variance();
            state.spreads[j] = spread.probability;
        }
        state.membership = state.memberships();
    }
    state.predict()
}

/// Present values of the coordinates that the rounds improve in turn.
struct State {
    ships: Vec<Likelihood>,
    /// Probability of each vessel to belong to the class.
    membership: Vec<f64>,
    /// Probability of each spread, by ratio.
    spreads: [[f64; SPREADS]; PARAMETERS],
    /// Variance of the class in each ratio.
    variance: Vector,
}

/// Distribution of the class's mean for given spreads.
struct ClassMean {
    log_evidence: f64,
    information: Matrix,
    score: Vector,
}

/// Posterior distribution of one ratio's spread on the grid.
struct Spread {
    probability: [f64; SPREADS],
    /// Mean of the class and its variance in that ratio, by spread.
    mean: [f64; SPREADS],
    mean_variance: [f64; SPREADS],
}

impl State {
    /// Returns the share of vessels that are like the class.
    fn weight(&self) -> f64 {
        let like: f64 = self.membership.iter().sum();
        let all = self.membership.len() as f64;
        (LIKE_BEFORE + like) / (LIKE_BEFORE + UNLIKE_BEFORE + all)
    }

    /// Returns the posterior of the class's mean when the class has `variance`.
    fn class_mean(&self, variance: &Vector) -> ClassMean {
        let before = variance.map(|within| 1.0 / (1.0 - within).max(LEAST_MEAN_VARIANCE));
        let mut information = Matrix::from_diagonal(&before);
        let mut score = Vector::zeros();
        let mut log_evidence: f64 = before.iter().map(|x| 0.5 * x.ln()).sum();
        for (ship, &membership) in self.ships.iter().zip(&self.membership) {
            let seen = of_the_mean(ship, variance);
            information += seen.information * membership;
            score += seen.score * membership;
            log_evidence += seen.log_evidence * membership;
        }
        let factor = cholesky(&information);
        log_evidence += 0.5 * score.dot(&factor.solve(&score));
        log_evidence -= factor.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        ClassMean {
            log_evidence,
            information,
            score,
        }
    }

    fn spread_of(&self, j: usize) -> Spread {
        let mut log_density = [0.0; SPREADS];
        let (mut mean, mut mean_variance) = ([0.0; SPREADS], [0.0; SPREADS]);
        let mut variance = self.variance;
        for g in 0..SPREADS {
            variance[j] = grid(g).powi(2);
            let class = self.class_mean(&variance);
            let covariance = cholesky(&class.information).inverse();
            mean[g] = (covariance * class.score)[j];
            mean_variance[g] = covariance[(j, j)];
            log_density[g] = class.log_evidence + self.spread_before(j, g).ln();
        }
        let largest = log_density.iter().copied().fold(f64::MIN, f64::max);
        let density = log_density.map(|x| (x - largest).exp());
        let sum: f64 = density.iter().sum();
        Spread {
            probability: density.map(|x| x / sum),
            mean,
            mean_variance,
        }
    }

    /// Returns the probability of a spread of ratio `j` by the other ratios of its kind: as
    /// one of them spreads, or any other spread, which counts as one of them.
    fn spread_before(&self, j: usize, g: usize) -> f64 {
        let permanent = |k: usize| matches!(k, 0 | 2);
        let kind = (0..PARAMETERS).filter(|&k| k != j && permanent(k) == permanent(j));
        // Every spread is as likely before, and the grid is even in its logarithm.
        let all: f64 = (0..SPREADS).map(grid).sum();
        grid(g) / all + kind.map(|k| self.spreads[k][g]).sum::<f64>()
    }

    /// Returns each vessel's probability to belong to the class that the others make.
    fn memberships(&self) -> Vec<f64> {
        let class = self.class_mean(&self.variance);
        let odds = (self.weight() / (1.0 - self.weight())).ln();
        let spread = Matrix::from_diagonal(&self.variance);
        let one = |(ship, &membership): (&Likelihood, &f64)| {
            let own = of_the_mean(ship, &self.variance);
            let others = cholesky(&(class.information - own.information * membership)).inverse();
            let mean = others * (class.score - own.score * membership);
            let like = ship.log_marginal(&mean, &(others + spread));
            let unlike = ship.log_marginal(&Vector::zeros(), &Matrix::identity());
            let ratio = like.zip(unlike).map_or(0.0, |(like, unlike)| like - unlike);
            1.0 / (1.0 + (-(odds + ratio)).exp())
        };
        self.ships.iter().zip(&self.membership).map(one).collect()
    }

    fn predict(&self) -> ClassFit {
        let class = self.class_mean(&self.variance);
        let mut covariance = cholesky(&class.information).inverse();
        let mean = covariance * class.score;
        for j in 0..PARAMETERS {
            let alone = self.spread_of(j).variance_about(mean[j]);
            covariance[(j, j)] = alone.max(covariance[(j, j)] + grid(0).powi(2));
        }
        let like: f64 = self.membership.iter().sum();
        ClassFit {
            weight: NEWCOMER_SHARE * self.weight(),
            mean,
            // A spread known from few vessels has tails that a normal distribution lacks: by
            // Student's and Fisher's 95 %, about one part in so many vessels.
            covariance: covariance * (1.0 + 1.0 / like.max(1.0)),
        }
    }
}

impl Spread {
    fn expected_variance(&self) -> f64 {
        let each = self.probability.iter().enumerate();
        each.map(|(g, p)| p * grid(g).powi(2)).sum()
    }

    /// Returns the variance of a new vessel's ratio about `centre`, over all spreads.
    fn variance_about(&self, centre: f64) -> f64 {
        let each = self.probability.iter().enumerate();
        each.map(|(g, p)| {
            p * (grid(g).powi(2) + self.mean_variance[g] + (self.mean[g] - centre).powi(2))
        })
        .sum()
    }
}

/// Returns the likelihood of the class's mean by one vessel, which differs from it by the
/// class's variance.
fn of_the_mean(ship: &Likelihood, variance: &Vector) -> ClassMean {
    let sd = variance.map(f64::sqrt);
    let root = Matrix::from_diagonal(&sd);
    let inner = cholesky(&(Matrix::identity() + root * ship.information * root));
    // Λ − Λ T^½ (1 + T^½ Λ T^½)⁻¹ T^½ Λ, which is (Λ⁻¹ + T)⁻¹ where Λ has an inverse.
    let gain = ship.information * root;
    let inverse = inner.inverse();
    let off = root * ship.score;
    let log_determinant: f64 = inner.l().diagonal().iter().map(|d| d.ln()).sum();
    ClassMean {
        log_evidence: 0.5 * off.dot(&(inverse * off)) - log_determinant,
        information: ship.information - gain * inverse * gain.transpose(),
        score: ship.score - gain * (inverse * off),
    }
}

fn grid(g: usize) -> f64 {
    let [least, greatest] = SPREAD_RANGE;
    least * (greatest / least).powf(g as f64 / (SPREADS - 1) as f64)
}

fn cholesky(matrix: &Matrix) -> nalgebra::Cholesky<f64, nalgebra::Const<PARAMETERS>> {
    nalgebra::Cholesky::new(*matrix)
        .expect("a prior's information plus the data's is positive definite")
}
