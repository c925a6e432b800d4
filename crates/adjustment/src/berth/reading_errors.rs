//! Errors of a berth reading.

/// Standard deviations of a berth reading, except for the magnetometer's gain: a relative
/// error of its scale is an equal relative error of λ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadingErrors {
    /// Error of each horizontal part, nT: magnetometer noise and unknown local field
    /// (crust, quay). More than 0.
    pub field_sd_nt: f64,
    /// Error of the magnetic heading, degrees: true heading and variation together.
    pub heading_sd_deg: f64,
    /// Error of the magnetometer's alignment, degrees.
    pub alignment_sd_deg: f64,
    /// Error of the magnetometer's tilt in roll and in pitch, degrees, including the ship's
    /// heel and trim: tilt mixes vertical field into the horizontal.
    pub tilt_sd_deg: f64,
}
