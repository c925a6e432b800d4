//! Plausible and usual values of λ.

/// Least plausible λ of a reasonably placed compass.
pub const LEAST_LAMBDA: f64 = 0.5;
/// Greatest plausible λ of any ship.
pub const GREATEST_LAMBDA: f64 = 1.25;
/// Usual range of λ: surrounding steel shields the compass, by up to a third in a
/// wheelhouse, and rarely concentrates the field. A reading outside this range needs a
/// second look.
pub const USUAL_LAMBDA: std::ops::RangeInclusive<f64> = 0.65..=1.1;
