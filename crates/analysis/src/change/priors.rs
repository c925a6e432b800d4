//! Prior probabilities of the change detector, and the sizes of jumps before any evidence.
//!
//! They are judgements, kept in one place so that they can be disputed. The rates of causes
//! are in [`super::cause`]; thresholds are in [`super::thresholds`].

// Steps and faults.

/// Prior log odds of a step at a port call, where cargo is loaded, against one within any
/// hour at sea.
pub(crate) const STEP_AT_PORT_CALL_LOG_ODDS: f64 = 4.0;
/// Prior log odds against a large step, beside a usual one.
pub(crate) const AGAINST_LARGE_STEP_LOG_ODDS: f64 = 2.0;
/// Prior log odds of a return at a port call against a transient.
pub(crate) const RETURN_OVER_TRANSIENT_LOG_ODDS: f64 = 3.0;
/// Prior log odds in favour of a competing hypothesis for each step that it makes needless.
pub(crate) const SPARED_STEP_LOG_ODDS: f64 = 6.0;
/// Prior probability that a port call changes the vessel's magnetism.
pub(crate) const CHANGE_AT_PORT_CALL: f64 = 0.02;
/// Prior probabilities, at the same time, of a reference's fault and of a transient.
pub(crate) const REFERENCE_FAULT: f64 = 0.002;
pub(crate) const TRANSIENT: f64 = 0.03;

// Cargo and returns.

/// Probability that a step which began at a port call is cargo.
pub(crate) const CARGO: f64 = 0.84;
/// Probability of cargo where the step began at the call or in the days after it: little
/// cargo is noticed late.
pub(crate) const CARGO_NOTICED_LATE: f64 = 0.6;
/// Probability of cargo where the step is dated at sea, soon after a call.
pub(crate) const CARGO_SOON_AFTER_CALL: f64 = 0.25;
/// Probability that cargo is discharged at any one port call.
pub(crate) const DISCHARGE: f64 = 0.6;
/// Probability of a return at a port call after a change at sea.
pub(crate) const RETURN_AFTER_CHANGE_AT_SEA: f64 = 0.01;
/// Probability of a return at a call at which the logbook has the discharge.
pub(crate) const LOGGED_DISCHARGE: f64 = 0.95;
/// Probability of a return where the vessel was under way at the logged discharge.
pub(crate) const LOGGED_DISCHARGE_UNDER_WAY: f64 = 0.5;
/// Probability of a return where the change was dated after sailing with the cargo.
pub(crate) const LOGGED_DISCHARGE_NOTICED_AT_SEA: f64 = 0.7;
/// Factor on the probability of a return where the logbook says that cargo stayed on board.
pub(crate) const LOGGED_ON_BOARD_FACTOR: f64 = 0.05;

// Sizes of jumps.

/// Standard deviation of a step in bx and by, in population units (1500 nT), and in the
/// induced parameters.
pub(crate) const STEP_SD: f64 = 0.8;
pub(crate) const INDUCED_STEP_SD: f64 = 0.3;
/// Standard deviation of a large step in bx and by, in population units.
pub(crate) const LARGE_STEP_SD: f64 = 6.0;
/// Standard deviation of a reference's step, degrees, unless the first reading after it is
/// further off.
pub(crate) const REFERENCE_STEP_SD_DEG: f64 = 5.0;
/// Standard deviation of a step of the compass's zero, degrees, unless the first reading
/// after it is further off.
pub(crate) const ALIGNMENT_STEP_SD_DEG: f64 = 5.0;
/// Standard deviation of the variation's error in a storm or over an anomaly, degrees where
/// H is 24 µT, and its correlation time.
pub(crate) const TRANSIENT_SD_DEG: f64 = 1.2;
pub(crate) const TRANSIENT_CORRELATION_S: f64 = 3600.0;
/// Standard deviation by which a vessel after a return may differ from what it was, in
/// population units.
pub(crate) const RETURN_SD: f64 = 0.06;
/// Variances of the drift of bx and by in thirty days, in population units: a vessel that
/// drifts slowly, and one that drifts fast.
pub(crate) const DRIFT_VARIANCES: [f64; 2] = [0.5, 4.0];
/// Length of a gap of which a supposed drift counts, seconds: with the whole of a longer
/// gap, any change in it would pass for a drift.
pub(crate) const DRIFT_IN_GAP_MAX_S: f64 = 12.0 * 3600.0;
/// Drift of bx and by in the thirty days after a step at sea, as a part of the step, and
/// its duration in seconds: what lightning leaves fades for weeks.
pub(crate) const STEP_DECAY_SHARE: f64 = 0.35;
pub(crate) const STEP_DECAY_S: f64 = 60.0 * 86_400.0;
