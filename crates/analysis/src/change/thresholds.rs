//! Thresholds of the change detector.
//!
//! Every decision compares log-likelihood ratios (natural logarithms) of filters that have
//! read the same rows. A larger threshold means fewer false alarms and a longer detection
//! delay; the rates that follow are measured by `examples/changes_study`. Rows are ten
//! minutes apart as a rule. Prior probabilities and jump sizes are in [`super::priors`].

// Steps.

/// Log-likelihood ratio of a step against a transient from which the step is accepted.
pub(crate) const STEP_LOG_LIKELIHOOD_RATIO: f64 = 10.5;
/// Log-likelihood ratio against a transient where the step is clear against no change.
pub(crate) const CLEAR_STEP_LOG_LIKELIHOOD_RATIO: f64 = 3.0;
/// Log-likelihood ratio of a step against no change from which it counts as clear.
pub(crate) const CLEAR_AGAINST_NULL_LOG_LIKELIHOOD_RATIO: f64 = 40.0;
/// Rows that a step must have lasted: the flank of an anomaly is as steep.
pub(crate) const STEP_MIN_ROWS: usize = 6;
/// Share of rows with one reference out of use, of two, from which a step needs
/// [`ONE_REFERENCE_LOG_LIKELIHOOD_RATIO`]: the reference that is left may be the one that fails.
pub(crate) const ONE_REFERENCE_SHARE: f64 = 0.3;
pub(crate) const ONE_REFERENCE_LOG_LIKELIHOOD_RATIO: f64 = 30.0;
/// Log-likelihood ratio between a step of the vessel and one of the reference from which
/// one reference alone tells them apart.
pub(crate) const VESSEL_OR_REFERENCE_LOG_LIKELIHOOD_RATIO: f64 = 4.0;
/// Rows back to the last difference of two references within which both count as read.
pub(crate) const BOTH_REFERENCES_ROWS: usize = 36;
/// Deficit of a large step against a usual one up to which it is preferred: the usual one
/// knows too little of what lies along the needle.
pub(crate) const LARGE_STEP_DEFICIT_LOG_LIKELIHOOD_RATIO: f64 = 3.0;
/// Lead of a new step or another cause up to which the step accepted before is kept.
pub(crate) const STEP_KEPT_LOG_LIKELIHOOD_RATIO: f64 = 8.0;
/// Rows after a step within which another step may be the same one.
pub(crate) const SAME_STEP_ROWS: usize = 432;
/// Duration below which a change that is over again, away from port, was not the vessel's.
pub(crate) const BRIEF_CHANGE_S: f64 = 24.0 * 3600.0;

// Vessels of which little is known, or that drift.

/// Time since the first row during which the noise levels rest on few days.
pub(crate) const NEW_VESSEL_S: f64 = 20.0 * 86_400.0;
/// Log-likelihood ratio added to the thresholds of steps and transients during that time.
pub(crate) const NEW_VESSEL_EXTRA_LOG_LIKELIHOOD_RATIO: f64 = 3.0;
/// Log-likelihood ratio added to the threshold of a step while the vessel drifts.
pub(crate) const DRIFTING_EXTRA_LOG_LIKELIHOOD_RATIO: f64 = 10.0;
/// Rows before which no lasting change is decided: without and with noise levels known
/// beforehand.
pub(crate) const WARM_UP_ROWS: usize = 300;
pub(crate) const WARM_UP_ROWS_KNOWN_NOISE: usize = 72;
/// First row to which a lasting change may be dated: without and with noise levels known
/// beforehand.
pub(crate) const FIRST_CHANGE_ROW: usize = 100;
pub(crate) const FIRST_CHANGE_ROW_KNOWN_NOISE: usize = 36;
/// First row of a transient, which comes and goes faster than the noise is learnt.
pub(crate) const FIRST_TRANSIENT_ROW: usize = 12;

// Faults of a reference.

/// Log-likelihood ratio of a reference's step against a transient from which it is accepted.
pub(crate) const REFERENCE_STEP_LOG_LIKELIHOOD_RATIO: f64 = 13.5;
/// Rows that a reference's step must have lasted: one wild reading is no fault.
pub(crate) const REFERENCE_STEP_MIN_ROWS: usize = 3;
/// Log-likelihood ratio of a repaired reference against a transient from which it is accepted.
pub(crate) const REFERENCE_REPAIR_LOG_LIKELIHOOD_RATIO: f64 = 8.0;
/// Deficit of a repaired reference against another change up to which it is accepted.
pub(crate) const REFERENCE_REPAIR_DEFICIT_LOG_LIKELIHOOD_RATIO: f64 = 3.0;

// Returns to the state before a change.

/// Log-likelihood ratio of a return at sea against a transient from which it is accepted.
pub(crate) const RETURN_AT_SEA_LOG_LIKELIHOOD_RATIO: f64 = 14.0;
/// Log-likelihood ratio that a step in port needs instead: cargo is not discharged at sea.
pub(crate) const CARGO_RETURN_AT_SEA_LOG_LIKELIHOOD_RATIO: f64 = 30.0;
/// Posterior probability from which a return at a port call is accepted.
pub(crate) const RETURN_POSTERIOR: f64 = 0.9;
/// Deficit of a return against a step to another state up to which it remains a candidate.
pub(crate) const RETURN_DEFICIT_LOG_LIKELIHOOD_RATIO: f64 = 6.0;
/// Posterior probability of a return from which it replaces a certain step near the port
/// call: so soon after the call a further step is far the rarer.
pub(crate) const RETURN_FOR_STEP_POSTERIOR: f64 = 0.3;
/// Rows before and after the port call within which a return may replace the step.
pub(crate) const RETURN_FOR_STEP_ROWS_BEFORE: usize = 18;
pub(crate) const RETURN_FOR_STEP_ROWS_AFTER: usize = 72;
/// Deficit of a return against the certain step up to which it may replace the step.
pub(crate) const RETURN_FOR_STEP_DEFICIT_LOG_LIKELIHOOD_RATIO: f64 = 10.0;
/// Deficit from which a return at a port call is dropped.
pub(crate) const RETURN_DROPPED_LOG_LIKELIHOOD_RATIO: f64 = 16.0;

// Transients.

/// Log-likelihood ratio of a transient against no change from which it is accepted.
pub(crate) const TRANSIENT_LOG_LIKELIHOOD_RATIO: f64 = 14.0;
/// Log-likelihood ratio of a transient against a lasting change from which it is accepted.
pub(crate) const TRANSIENT_OVER_CHANGE_LOG_LIKELIHOOD_RATIO: f64 = 3.0;
/// Log-likelihood ratio against other hypotheses from which an ended transient's filter
/// becomes the null filter.
pub(crate) const ENDED_TRANSIENT_OVER_CHANGE_LOG_LIKELIHOOD_RATIO: f64 = 6.0;
/// Time since the end of a transient after which its filter may become the null filter.
pub(crate) const TRANSIENT_OVER_FOR_S: f64 = 6.0 * 3600.0;
/// Longest duration of a transient: a long magnetic storm.
pub(crate) const TRANSIENT_MAX_S: f64 = 36.0 * 3600.0;
/// Error of the variation beyond which a row counts as disturbed, degrees where H is 24 µT.
pub(crate) const DISTURBED_VARIATION_DEG: f64 = 0.7;
/// Innovation beyond which a transient may be a severe one, degrees where H is 24 µT.
pub(crate) const SEVERE_TRANSIENT_DEG: f64 = 3.5;
/// Log-likelihood ratio from which a transient is noted that one vessel alone cannot confirm.
pub(crate) const WEAK_TRANSIENT_LOG_LIKELIHOOD_RATIO: f64 = 7.0;
/// Rows without a larger lead after which a weak transient is over.
pub(crate) const WEAK_TRANSIENT_OVER_ROWS: usize = 36;

// Competing explanations of a step: drift, or an alignment change of the compass.

/// Log-likelihood ratio of a competing hypothesis against the step from which it replaces it.
pub(crate) const COMPETING_LOG_LIKELIHOOD_RATIO: f64 = 8.0;
/// Log-likelihood ratio where it replaces several steps: one change is likelier than more.
pub(crate) const COMPETING_WITH_SEVERAL_LOG_LIKELIHOOD_RATIO: f64 = 3.0;
/// Deficit of a competing hypothesis against a further step up to which it is accepted.
pub(crate) const COMPETING_DEFICIT_LOG_LIKELIHOOD_RATIO: f64 = 3.0;
/// Log-likelihood ratio added for a drift where cargo is likely: all steps were dated in
/// port or with cargo on board.
pub(crate) const DRIFT_WITH_CARGO_EXTRA_LOG_LIKELIHOOD_RATIO: f64 = 16.0;
/// Rows by which such a drift must begin before the first step.
pub(crate) const DRIFT_BEFORE_CARGO_ROWS: usize = 72;
/// Deficit from which a competing hypothesis is dropped, and its greatest age in rows.
pub(crate) const COMPETING_DROPPED_LOG_LIKELIHOOD_RATIO: f64 = 20.0;
pub(crate) const COMPETING_MAX_ROWS: usize = 8640;
/// Sectors of heading, sectors between two that tell an alignment change from a step, and
/// rows in each of the two: headings 30° apart and more.
pub(crate) const ALIGNMENT_SECTORS: usize = 36;
pub(crate) const ALIGNMENT_SECTORS_BETWEEN: usize = 3;
pub(crate) const ALIGNMENT_SECTOR_ROWS: usize = 3;

// Withdrawal of a step.

/// Log-likelihood ratio of no step against the step from which the step is withdrawn.
pub(crate) const WITHDRAWAL_LOG_LIKELIHOOD_RATIO: f64 = 3.0;
/// Rows after which a step may be withdrawn: half a day of sailing.
pub(crate) const WITHDRAWAL_MIN_ROWS: usize = 72;
/// Log-likelihood ratio of a transient above which the rows say nothing of the vessel.
pub(crate) const WITHDRAWAL_MAX_TRANSIENT_LOG_LIKELIHOOD_RATIO: f64 = 3.0;
/// Deficit from which the hypothesis of no step is dropped: later, and in the first rows,
/// which may resemble a step only.
pub(crate) const NO_STEP_DROPPED_LOG_LIKELIHOOD_RATIO: f64 = 25.0;
pub(crate) const NO_STEP_DROPPED_EARLY_LOG_LIKELIHOOD_RATIO: f64 = 45.0;

// What is open when the rows end.

/// Log-likelihood ratio against no change from which an unconfirmed event is reported.
pub(crate) const SUSPICION_LOG_LIKELIHOOD_RATIO: f64 = 8.0;
/// Log-likelihood ratio of a large step against no change from which it widens the band.
pub(crate) const UNDECIDED_STEP_LOG_LIKELIHOOD_RATIO: f64 = 5.0;
/// Deficit against another hypothesis from which a large step is excluded.
pub(crate) const EXCLUDED_STEP_LOG_LIKELIHOOD_RATIO: f64 = 25.0;
/// Smallest step that widens the band, in population units of 1500 nT.
pub(crate) const UNDECIDED_STEP_MIN_SIZE: f64 = 0.5;
/// Rows for which a past transient may have been a step: three days.
pub(crate) const UNDECIDED_STEP_ROWS: usize = 432;
/// Rows back to the port calls at which an undetected step is considered.
pub(crate) const UNDETECTED_STEP_ROWS: usize = 288;

// Large steps.

/// Innovation beyond which a large step is supposed, degrees where H is 24 µT.
pub(crate) const LARGE_STEP_DEG: f64 = 4.0;
/// Age in rows up to which a fork may still begin a large step: on one course a vessel does
/// not show what lies along its needle.
pub(crate) const LARGE_STEP_MAX_ROWS: usize = 72;

// Dates.

/// Deficit against the likeliest date up to which another row may be the date: half of the
/// 95 % point of χ² with one degree of freedom.
pub(crate) const DATE_LOG_LIKELIHOOD_RATIO: f64 = 1.92;
/// Rows about the likeliest date within which a port call may be the date, and its greatest
/// deficit against the likeliest row.
pub(crate) const DATE_AT_PORT_CALL_ROWS: usize = 144;
pub(crate) const DATE_AT_PORT_CALL_LOG_LIKELIHOOD_RATIO: f64 = 8.0;
/// Time after a port call within which a step may be cargo that was noticed late.
pub(crate) const CARGO_NOTICED_LATE_S: f64 = 3.0 * 86_400.0;

// Logbook entries of cargo.

/// Tolerance of the times in the logbook: people write down the day, or when the hatches
/// were shut.
pub(crate) const LOGBOOK_TOLERANCE_S: f64 = 12.0 * 3600.0;
/// Time after which an entry without an end counts as discharged.
pub(crate) const OPEN_CARGO_ENTRY_S: f64 = 21.0 * 86_400.0;
/// Rows of sailing after which a step was not the loading: half of it for what people
/// write, half for dating.
pub(crate) const SAILED_SINCE_ROWS: usize = 36;

// Forks of the filter.

/// Rows between forks: about an hour of sailing.
pub(crate) const FORK_INTERVAL_ROWS: usize = 6;
/// Innovation from which a fork is made out of turn, in standard deviations by the
/// covariance of the row before, which makes it one row in eight; and the rows since the
/// last fork.
pub(crate) const FORK_INNOVATION_SD: f64 = 3.0;
pub(crate) const FORK_INNOVATION_MIN_ROWS: usize = 2;
/// Gap after which the next row gets a fork.
pub(crate) const FORK_AFTER_GAP_S: f64 = 2.0 * 3600.0;
/// Log-likelihood ratio of a transient from which a fork supposes its end.
pub(crate) const TRANSIENT_END_FORK_LOG_LIKELIHOOD_RATIO: f64 = 3.0;
/// Log-likelihood ratio of a step from which all other hypotheses run too, and below which
/// they stop.
pub(crate) const WAKE_LOG_LIKELIHOOD_RATIO: f64 = 7.0;
pub(crate) const SLEEP_LOG_LIKELIHOOD_RATIO: f64 = 6.0;
/// Sum of excess losses from which the other hypotheses run for [`AWAKE_MIN_ROWS`]: a storm
/// goes to and fro, and no step follows it.
pub(crate) const WAKE_EXCESS_LOSS: f64 = 4.0;
pub(crate) const AWAKE_MIN_ROWS: usize = 18;
/// Greatest excess loss that one row adds to the sum, lest one wild reading suffice, and
/// the loss that each row takes off it.
pub(crate) const ROW_MAX_EXCESS_LOSS: f64 = 2.5;
pub(crate) const ROW_FORGOTTEN_EXCESS_LOSS: f64 = 0.75;
/// Deficit from which a step is dropped, and its least age in rows.
pub(crate) const STEP_DROPPED_LOG_LIKELIHOOD_RATIO: f64 = 2.0;
pub(crate) const STEP_DROPPED_MIN_ROWS: usize = 48;
