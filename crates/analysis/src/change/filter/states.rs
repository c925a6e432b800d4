//! Indices of the filter's states.

use crate::estimate::{CONSTANT, UNKNOWNS};

/// Number of states: the seven parameters in population units, the constant, the gyro's
/// residual speed error, and the residual difference of the references; then Schuler swing
/// and rate, slow gyro error, compass swing, variation error and satellite compass's error,
/// degrees.
pub(crate) const STATES: usize = 16;
/// Number of states on which a row's prediction depends.
pub(crate) const LASTING: usize = 10;
pub(crate) const SPEED: usize = 8;
pub(crate) const OFFSET: usize = 9;
pub(crate) const SWING: usize = 10;
pub(crate) const RATE: usize = 11;
pub(crate) const SLOW: usize = 12;
pub(crate) const VARIATION: usize = 14;
pub(crate) const SATELLITE: usize = 15;
/// Index of the offset among the estimator's unknowns.
pub(crate) const OFFSET_UNKNOWN: usize = UNKNOWNS - 1;
pub(crate) const DRIFTING: [usize; 2] = [0, 2];

/// Index of the constant, the same as among the unknowns.
pub(crate) const CONSTANT_STATE: usize = CONSTANT;
