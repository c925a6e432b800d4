//! Observation: a compass heading with the measured deviation and the earth's field.

use binnacle_compass::angle::{CompassHeading, Deviation, Variation};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;

/// A measured deviation for any of the fits.
///
/// `deviation` is reference less variation less compass, so that it includes the errors of
/// reference and variation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Time; none when the source did not give it, and then noise is taken as independent
    /// from row to row.
    pub time: Option<Timestamp>,
    /// Position; none when the source gave the field instead.
    pub position: Option<Position>,
    /// Raw compass heading.
    pub compass: CompassHeading,
    /// Reference less variation less compass.
    pub deviation: Deviation,
    /// Variation of the earth's field there and then.
    pub variation: Variation,
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
    /// Share of a gyro in the reference heading: 1 for a gyro, 0 for a satellite compass,
    /// between for a mean of both.
    pub gyro_share: f64,
    /// Gyro less satellite compass where both were read, degrees, without their usual
    /// difference.
    pub gyro_less_satellite_deg: Option<f64>,
    /// Speed over ground, knots.
    pub sog_kn: Option<f64>,
    /// Number of ten-second windows in the row, at least 1.
    pub windows: u16,
    /// Standard deviation of compass less reference among the windows, degrees.
    pub spread_deg: Option<f64>,
    /// Weight beside the other rows; 1 where none is given.
    pub weight: f64,
}

/// Returns the harmonic mean of the horizontal field over observations, nT: the field at which
/// a fit contains a part of D that grows as 1/H. None without weight.
pub fn mean_h_nt(observations: &[Observation]) -> Option<f64> {
    let (weights, inverse) = observations
        .iter()
        .fold((0.0, 0.0), |(weights, inverse), o| {
            (weights + o.weight, inverse + o.weight / o.h_nt)
        });
    let mean = weights / inverse;
    mean.is_finite().then_some(mean)
}
