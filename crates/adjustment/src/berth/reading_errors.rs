//! Errors of a berth reading.

/// Standard deviations of a berth reading. The magnetometer's gain is not among
/// them: an error of its scale is an error of λ, share for share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadingErrors {
    /// Of each horizontal part, nT: the magnetometer's noise together with what
    /// the earth's field at the berth is not known to (crust, quay). More than 0.
    pub field_sd_nt: f64,
    /// Of the magnetic heading, degrees: that of the true heading together with
    /// the variation's.
    pub heading_sd_deg: f64,
    /// Of the magnetometer's alignment, degrees.
    pub alignment_sd_deg: f64,
    /// Of the magnetometer's tilt in roll and in pitch, degrees, ship's heel
    /// and trim included: tilt brings vertical field into the horizontal.
    pub tilt_sd_deg: f64,
}
