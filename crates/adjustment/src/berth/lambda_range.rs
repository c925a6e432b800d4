//! Plausible and usual values of λ.

/// Less of the earth's field than this reaches no compass that was placed with any care.
pub const LEAST_LAMBDA: f64 = 0.5;
/// No ship gathers more of it at the compass than this.
pub const GREATEST_LAMBDA: f64 = 1.25;
/// Steel around a compass shields it, in a wheelhouse by up to a third, and hardly ever
/// gathers more of the field than there is. Outside this a reading is looked at again.
pub const USUAL_LAMBDA: std::ops::RangeInclusive<f64> = 0.65..=1.1;
