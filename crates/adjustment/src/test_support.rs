//! Random ships and places for tests.

use binnacle_compass::ship::{EarthField, ShipMagnetism};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

pub(crate) fn random_ship(rng: &mut ChaCha8Rng) -> ShipMagnetism {
    ShipMagnetism {
        chi: std::array::from_fn(|_| std::array::from_fn(|_| rng.random_range(-0.15..0.15))),
        b_nt: std::array::from_fn(|_| rng.random_range(-5_000.0..5_000.0)),
    }
}

pub(crate) fn random_earth(rng: &mut ChaCha8Rng) -> EarthField {
    EarthField {
        h_nt: rng.random_range(16_000.0..40_000.0),
        z_nt: rng.random_range(-55_000.0..55_000.0),
    }
}
