//! Ships of a class, their voyages, and a linear estimator: independent of the product's own
//! code, whose types alone it uses.
//!
//! The deviation is the five-term approximation, linear in the seven ratios; errors are
//! normal and independent. Fields are in µT here, and in nT at the edge to the product.

use binnacle_compass::model::{Covariance, Model, Parameters, ReferenceGrade};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Spread of ships at large: bx, χ13, by, χ23, χ11−χ22, χ12, χ21; µT or 1.
pub(crate) const POPULATION: [f64; 7] = [1.5, 0.012, 1.5, 0.006, 0.02, 0.008, 0.008];
/// Spread of the constant, degrees.
const CONSTANT_SD: f64 = 0.9;
/// nT in one unit of each number here.
const NT: [f64; 8] = [1000.0, 1.0, 1000.0, 1.0, 1.0, 1.0, 1.0, 1.0];

/// The earth's field, µT: horizontal, and down.
#[derive(Clone, Copy)]
pub(crate) struct Sea {
    pub(crate) h: f64,
    pub(crate) z: f64,
}

pub(crate) const MEDITERRANEAN: Sea = Sea { h: 26.0, z: 37.0 };
/// Forty degrees of latitude to the south.
pub(crate) const FAR: Sea = Sea { h: 30.0, z: -10.0 };
const SEAS: [Sea; 6] = [
    MEDITERRANEAN,
    FAR,
    Sea { h: 17.0, z: 47.0 },
    Sea { h: 27.0, z: 24.0 },
    Sea { h: 11.0, z: -23.0 },
    Sea { h: 23.0, z: -53.0 },
];

/// The seven ratios and the constant.
pub(crate) type Truth = DVector<f64>;

/// Slopes of the deviation, degrees, by ratio and constant.
fn slopes(sea: Sea, heading_deg: f64) -> [f64; 8] {
    let (s, c) = heading_deg.to_radians().sin_cos();
    let (s2, c2) = (2.0 * heading_deg).to_radians().sin_cos();
    [
        s / sea.h,
        s * sea.z / sea.h,
        c / sea.h,
        c * sea.z / sea.h,
        s2 / 2.0,
        f64::midpoint(c2, -1.0),
        f64::midpoint(c2, 1.0),
        1.0_f64.to_radians(),
    ]
    .map(f64::to_degrees)
}

/// A normal distribution of ratios and constant.
#[derive(Clone)]
pub(crate) struct Normal {
    pub(crate) mean: DVector<f64>,
    pub(crate) covariance: DMatrix<f64>,
}

impl Normal {
    pub(crate) fn population() -> Normal {
        let mut variance = DVector::from_element(8, CONSTANT_SD * CONSTANT_SD);
        for (v, sd) in variance.iter_mut().zip(POPULATION) {
            *v = sd * sd;
        }
        Normal {
            mean: DVector::zeros(8),
            covariance: DMatrix::from_diagonal(&variance),
        }
    }

    /// A component of the product's prior, with the constant's beside it.
    pub(crate) fn of(mean: &[f64; 7], covariance: &[[f64; 7]; 7]) -> Normal {
        let mut out = Normal::population();
        for i in 0..7 {
            out.mean[i] = mean[i] / NT[i];
            for j in 0..7 {
                out.covariance[(i, j)] = covariance[i][j] / (NT[i] * NT[j]);
            }
        }
        out
    }

    pub(crate) fn log_density(&self, at: &DVector<f64>) -> f64 {
        let factor = self.covariance.clone().cholesky().expect("a covariance");
        let z = factor
            .l()
            .solve_lower_triangular(&(at - &self.mean))
            .expect("regular");
        let log_det: f64 = factor.l().diagonal().iter().map(|d| d.ln()).sum();
        -0.5 * z.norm_squared() - log_det
    }

    /// The product's model with this posterior.
    pub(crate) fn model(&self) -> Model {
        let values = std::array::from_fn(|j| self.mean[j] * NT[j]);
        let covariance: Covariance = std::array::from_fn(|i| {
            std::array::from_fn(|j| self.covariance[(i, j)] * NT[i] * NT[j])
        });
        Model {
            parameters_over_lambda: Parameters::from_array(values),
            constant_deg: self.mean[7],
            covariance: Some(covariance),
            identifiable: None,
            rms_deg: None,
            samples_used: 0,
            samples_rejected: 0,
            quality: None,
            reference_grade: ReferenceGrade::Heading,
            mean_h_nt: None,
            needles: None,
        }
    }
}

/// Headings that a ship steered in some seas, and the deviations read, degrees.
pub(crate) struct Voyage {
    slopes: DMatrix<f64>,
    read: DVector<f64>,
    noise_sd: f64,
}

impl Voyage {
    /// Reads the deviation on `headings` even headings in each sea, within `noise_sd` each.
    pub(crate) fn sail(
        truth: &Truth,
        seas: &[Sea],
        headings: usize,
        noise_sd: f64,
        dice: &mut Dice,
    ) -> Voyage {
        let rows: Vec<[f64; 8]> = seas
            .iter()
            .flat_map(|&sea| {
                (0..headings).map(move |k| slopes(sea, k as f64 * 360.0 / headings as f64))
            })
            .collect();
        let slopes = DMatrix::from_fn(rows.len(), 8, |i, j| rows[i][j]);
        let noise = DVector::from_fn(rows.len(), |_, _| dice.normal() * noise_sd);
        Voyage {
            read: &slopes * truth + noise,
            slopes,
            noise_sd,
        }
    }

    /// Posterior, and the log-likelihood of the whole voyage under the prior.
    pub(crate) fn posterior(&self, prior: &Normal) -> (Normal, f64) {
        let n = self.read.len();
        let gain = &prior.covariance * self.slopes.transpose();
        let innovation = Normal {
            mean: &self.slopes * &prior.mean,
            covariance: &self.slopes * &gain + DMatrix::identity(n, n) * self.noise_sd.powi(2),
        };
        let inverse = innovation
            .covariance
            .clone()
            .cholesky()
            .expect("noise")
            .inverse();
        let update = &gain * &inverse;
        let posterior = Normal {
            mean: &prior.mean + &update * (&self.read - &innovation.mean),
            covariance: &prior.covariance - &update * gain.transpose(),
        };
        (posterior, innovation.log_density(&self.read))
    }
}

/// Weighted normal distributions.
pub(crate) struct Mixture(pub(crate) Vec<(f64, Normal)>);

impl Mixture {
    pub(crate) fn after(&self, voyage: &Voyage) -> Mixture {
        let each: Vec<(f64, Normal)> = self
            .0
            .iter()
            .map(|(weight, prior)| {
                let (posterior, log_likelihood) = voyage.posterior(prior);
                (weight.ln() + log_likelihood, posterior)
            })
            .collect();
        let most = each.iter().map(|(l, _)| *l).fold(f64::MIN, f64::max);
        let sum: f64 = each.iter().map(|(l, _)| (l - most).exp()).sum();
        Mixture(
            each.into_iter()
                .map(|(l, p)| ((l - most).exp() / sum, p))
                .collect(),
        )
    }

    fn log_density(&self, at: &DVector<f64>) -> f64 {
        self.0
            .iter()
            .map(|(w, p)| w * p.log_density(at).exp())
            .sum::<f64>()
            .ln()
    }

    /// True if the truth lies in the region of greatest density that holds 95 %.
    pub(crate) fn region_holds(&self, truth: &Truth, dice: &mut Dice) -> bool {
        const DRAWS: usize = 400;
        let at_truth = self.log_density(truth);
        let lower = (0..DRAWS)
            .filter(|_| {
                let draw = self.draw(dice);
                self.log_density(&draw) < at_truth
            })
            .count();
        lower as f64 >= 0.05 * DRAWS as f64
    }

    /// True if the truth lies in the first component's own 95 % region of the seven ratios.
    pub(crate) fn class_region_holds(&self, truth: &Truth) -> bool {
        /// 95 % of χ² with seven degrees of freedom.
        const CHI_SQUARE: f64 = 14.067;
        let (_, class) = &self.0[0];
        let ratios = class.covariance.view((0, 0), (7, 7)).into_owned();
        let off = (truth - &class.mean).rows(0, 7).into_owned();
        let solved = ratios.cholesky().expect("a covariance").solve(&off);
        off.dot(&solved) <= CHI_SQUARE
    }

    /// Normal distribution of the same mean and covariance.
    pub(crate) fn matched(&self) -> Normal {
        let mean: DVector<f64> = self.0.iter().map(|(w, p)| &p.mean * *w).sum();
        let mut covariance = DMatrix::zeros(8, 8);
        for (w, p) in &self.0 {
            let off = &p.mean - &mean;
            covariance += (&p.covariance + &off * off.transpose()) * *w;
        }
        Normal { mean, covariance }
    }

    fn draw(&self, dice: &mut Dice) -> DVector<f64> {
        let mut left = dice.even();
        let chosen = self.0.iter().find(|(w, _)| {
            left -= w;
            left <= 0.0
        });
        let (_, from) = chosen.unwrap_or(&self.0[0]);
        let z = DVector::from_fn(8, |_, _| dice.normal());
        &from.mean
            + from
                .covariance
                .clone()
                .cholesky()
                .expect("a covariance")
                .l()
                * z
    }

    /// Share of 24 headings on which the 95 % band of the deviation, by the mixture's mean
    /// and covariance, holds the truth, and the mean half-width of that band, degrees.
    pub(crate) fn band(&self, truth: &Truth, sea: Sea) -> Band {
        let Normal { mean, covariance } = self.matched();
        let mut band = Band {
            held: 0.0,
            width: 0.0,
        };
        for k in 0..24 {
            let row = DVector::from_row_slice(&slopes(sea, f64::from(k) * 15.0));
            let half = 1.96 * row.dot(&(&covariance * &row)).sqrt();
            let off = row.dot(&(truth - &mean)).abs();
            band.held += f64::from(u8::from(off <= half)) / 24.0;
            band.width += half / 24.0;
        }
        band
    }
}

#[derive(Clone, Copy)]
pub(crate) struct Band {
    pub(crate) held: f64,
    pub(crate) width: f64,
}

/// A class of ships: its mean, and its spread as a share of the population's. Ships of all
/// classes together have the population's spread.
pub(crate) struct ShipClass {
    mean: [f64; 7],
    share: [f64; 7],
}

impl ShipClass {
    /// A class whose induced ratios spread `induced` of the population's, and whose
    /// permanent ones spread as the population's.
    pub(crate) fn new(induced: f64, dice: &mut Dice) -> ShipClass {
        let share = std::array::from_fn(|j| if matches!(j, 0 | 2) { 1.0 } else { induced });
        let mean = std::array::from_fn(|j| {
            let share: f64 = share[j];
            POPULATION[j] * (1.0 - share * share).max(0.0).sqrt() * dice.normal()
        });
        ShipClass { mean, share }
    }

    pub(crate) fn ship(&self, dice: &mut Dice) -> Truth {
        DVector::from_fn(8, |j, _| match self.mean.get(j) {
            Some(mean) => mean + POPULATION[j] * self.share[j] * dice.normal(),
            None => CONSTANT_SD * dice.normal(),
        })
    }
}

/// A ship at large.
pub(crate) fn any_ship(dice: &mut Dice) -> Truth {
    let sd = |j: usize| POPULATION.get(j).copied().unwrap_or(CONSTANT_SD);
    DVector::from_fn(8, |j, _| sd(j) * dice.normal())
}

/// Posterior, under the population's prior, of a ship that sailed one to three seas.
pub(crate) fn known_by_now(truth: &Truth, dice: &mut Dice) -> Normal {
    let seas: Vec<Sea> = (0..=dice.below(4))
        .map(|_| SEAS[dice.below(SEAS.len())])
        .collect();
    let voyage = Voyage::sail(truth, &seas, 24, 0.5, dice);
    voyage.posterior(&Normal::population()).0
}

/// Numbers at random, the same for the same seed.
pub(crate) struct Dice(ChaCha8Rng);

impl Dice {
    pub(crate) fn new(seed: u64) -> Dice {
        Dice(ChaCha8Rng::seed_from_u64(seed))
    }

    pub(crate) fn even(&mut self) -> f64 {
        self.0.random()
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.0.random_range(0..n)
    }

    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.even()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.even()).cos()
    }
}
