//! One row of a fit: a compass heading with the deviation measured on it and
//! the earth's field around it.

use binnacle_compass::angle::{CompassHeading, Deviation, Variation};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;

/// A measured deviation, ready for any of the fits.
///
/// `deviation` is reference less variation less compass, so that the
/// reference's own error and the variation's stand in it too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// When; none when the source did not say, and then noise is taken for
    /// independent from row to row.
    pub time: Option<Timestamp>,
    /// Where; none when the source gave the field in place of the position.
    pub position: Option<Position>,
    /// The raw compass heading.
    pub compass: CompassHeading,
    /// Reference less variation less compass.
    pub deviation: Deviation,
    /// The earth's variation there and then.
    pub variation: Variation,
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
    /// What part of the reference heading is a gyro's: 1 for a gyro, 0 for a
    /// satellite compass, between for a mean of both.
    pub gyro_share: f64,
    /// Gyro less satellite compass where both were read, degrees, their usual
    /// difference taken off.
    pub gyro_less_satellite_deg: Option<f64>,
    /// Speed over ground, knots.
    pub sog_kn: Option<f64>,
    /// Ten-second windows behind the row, at least 1.
    pub windows: u16,
    /// Standard deviation of compass less reference among them, degrees.
    pub spread_deg: Option<f64>,
    /// How much the row counts beside the others; 1 where nothing is said.
    pub weight: f64,
}
