//! Patches of magnetic sea bed, where the variation is not the chart's.

use super::Passage;
use binnacle_compass::angle::wrap_180;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// A patch of magnetic sea bed.
pub(super) struct Patch {
    lat: f64,
    lon: f64,
    radius_nm: f64,
    peak_deg: f64,
}

impl Patch {
    /// Makes a patch where the ship will arrive in about an hour.
    pub(super) fn ahead(on: &Passage, rng: &mut ChaCha8Rng) -> Patch {
        let radius_nm = 3.0 + 9.0 * rng.random::<f64>();
        let ahead_deg = 3.0 * radius_nm / 60.0;
        let (sin, cos) = on.course.to_radians().sin_cos();
        let side = if rng.random::<bool>() { 1.0 } else { -1.0 };
        Patch {
            lat: on.lat + ahead_deg * cos,
            lon: on.lon + ahead_deg * sin / on.lat.to_radians().cos(),
            radius_nm,
            peak_deg: side * (1.5 + 3.5 * rng.random::<f64>()),
        }
    }

    /// Returns the error of the variation, degrees.
    pub(super) fn at(&self, on: &Passage) -> f64 {
        let north = on.lat - self.lat;
        let east = wrap_180(on.lon - self.lon) * on.lat.to_radians().cos();
        let distance = 60.0 * north.hypot(east) / self.radius_nm;
        self.peak_deg * (-distance * distance / 2.0).exp()
    }
}
