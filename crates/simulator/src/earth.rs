//! The earth's field where the ship is, in the one place that asks for it.

use binnacle_magnetics::position::Position;
use binnacle_magnetics::time::Timestamp;

/// The field in geographic axes, nT.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EarthField {
    pub(crate) north_nt: f64,
    pub(crate) east_nt: f64,
    pub(crate) down_nt: f64,
}

impl EarthField {
    pub(crate) fn variation_deg(&self) -> f64 {
        self.east_nt.atan2(self.north_nt).to_degrees()
    }

    pub(crate) fn h_nt(&self) -> f64 {
        self.north_nt.hypot(self.east_nt)
    }

    /// Latitude of the place were the earth's field a dipole's, degrees.
    pub(crate) fn magnetic_latitude_deg(&self) -> f64 {
        (self.down_nt / self.h_nt() / 2.0).atan().to_degrees()
    }
}

/// The earth's field by IGRF-14 at sea level.
pub(crate) fn field_at(position: Position, time: Timestamp) -> EarthField {
    // A centred dipole of 2025 until the field module lands.
    let _ = time;
    let (lat, lon) = (position.lat_deg().to_radians(), position.lon_deg().to_radians());
    let (g10, g11, h11) = (-29_350.0, -1_410.0, 4_545.0);
    let (sin, cos) = lat.sin_cos();
    let along = g11 * lon.cos() + h11 * lon.sin();
    EarthField {
        north_nt: -g10 * cos + along * sin,
        east_nt: g11 * lon.sin() - h11 * lon.cos(),
        down_nt: -2.0 * (g10 * sin + along * cos),
    }
}
