//! Repeatable random numbers: the same seed, ship and purpose give the same
//! numbers.

pub(crate) mod process;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A source of random numbers for one purpose on one ship.
///
/// Purposes draw from separate streams, so that a change in one part of a ship
/// leaves the numbers of all others unchanged.
#[derive(Clone, Debug)]
pub(crate) struct Random {
    generator: ChaCha8Rng,
    spare: Option<f64>,
}

impl Random {
    pub(crate) fn new(seed: u64, ship: &str, purpose: &str) -> Random {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(hash(&[ship, purpose]));
        Random {
            generator,
            spare: None,
        }
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        (self.generator.next_u64() >> 11) as f64 * 2f64.powi(-53)
    }

    /// Uniform between two numbers.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// One or minus one.
    pub(crate) fn sign(&mut self) -> f64 {
        if self.unit() < 0.5 { -1.0 } else { 1.0 }
    }

    /// Time until an event that happens once in `mean` on average.
    pub(crate) fn waiting(&mut self, mean: f64) -> f64 {
        -mean * (1.0 - self.unit()).ln()
    }

    /// Gaussian with mean 0 and standard deviation 1 (Marsaglia & Bray 1964).
    pub(crate) fn gaussian(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let x = self.between(-1.0, 1.0);
            let y = self.between(-1.0, 1.0);
            let square = x * x + y * y;
            if square < 1.0 && square > 0.0 {
                let factor = (-2.0 * square.ln() / square).sqrt();
                self.spare = Some(y * factor);
                return x * factor;
            }
        }
    }
}

/// FNV-1a over the parts, with a separator between them.
fn hash(parts: &[&str]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for part in parts {
        for byte in part.bytes().chain([0xff]) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_purpose_repeats_and_two_differ() {
        let draw = |purpose| Random::new(5, "Alba", purpose).unit();
        assert!((draw("gyro") - draw("gyro")).abs() < f64::EPSILON);
        assert!((draw("gyro") - draw("compass")).abs() > 1e-12);
    }

    #[test]
    fn gaussian_numbers_have_mean_zero_and_variance_one() {
        let mut random = Random::new(1, "", "");
        let draws: Vec<f64> = (0..100_000).map(|_| random.gaussian()).collect();
        let mean = draws.iter().sum::<f64>() / 1e5;
        let variance = draws.iter().map(|x| x * x).sum::<f64>() / 1e5;
        assert!(mean.abs() < 0.015, "mean {mean}");
        assert!((variance - 1.0).abs() < 0.02, "variance {variance}");
        assert!(draws.iter().any(|x| x.abs() > 3.5), "the tails are there");
    }
}
