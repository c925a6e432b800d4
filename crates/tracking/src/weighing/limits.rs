//! Limits of the search over hypotheses: what is worth a look, what is given up, and when.
//!
//! None of them is a property of ships. A smaller limit saves time, a larger one keeps what may
//! turn out right; each was chosen as the cheapest beyond which the study of sound ships and of
//! causes (`cargo run --example real_ships_study`) does not change.

/// Usual time between rows, seconds (`docs/agent.md`: a sample each ten minutes).
pub(super) const ROW_S: f64 = 600.0;
/// Rows of an hour and of a day.
pub(super) const HOUR_ROWS: usize = (3600.0 / ROW_S) as usize;
pub(super) const DAY_ROWS: usize = 24 * HOUR_ROWS;
/// Rows of a week, after which it is known how a ship began. Her usual noise is known after two,
/// and the size of her habits after four.
pub(super) const WEEK_ROWS: usize = 7 * DAY_ROWS;
/// Rows that are kept, so that an event may be supposed among them: three days.
pub(super) const KEPT_ROWS: usize = 3 * DAY_ROWS;

/// Log weight within which two accounts are about as likely, and log likelihood ratio from which
/// one more event is worth a look: odds of fifty.
pub(super) const UNCERTAIN: f64 = 4.0;
/// Log weight above all others' from which the lead may teach the ship's habits: odds of twenty.
pub(super) const CERTAIN: f64 = 3.0;
/// Log weight below the best's from which an account changes no result: odds of a thousand.
pub(super) const NEGLIGIBLE: f64 = 7.0;
/// Log weight below the best's at which an account is given up.
pub(super) const GIVEN_UP: f64 = 12.0;
/// Such a log weight for the likeliest account that supposes fewer events than the lead, passing
/// ones apart: on one course a storm can feign a strike, until the next turn.
pub(super) const SIMPLER_GIVEN_UP: f64 = 40.0;
/// Log weight by which an account has become better than before.
pub(super) const BETTER: f64 = 1.0;
/// Accounts beside the lead under which an event is supposed, too.
pub(super) const ALTERNATIVES: usize = 3;
/// Most accounts.
pub(super) const MOST_HYPOTHESES: usize = 40;
/// Probability from which a date of an event is credible, and below which the event is left out.
pub(super) const IMPROBABLE: f64 = 0.02;

/// Seconds within which two events of a kind are one.
pub(super) const SAME_S: f64 = 6.0 * 3600.0;
/// Seconds after which an event that is over, or whose end is none, is no longer judged.
pub(super) const SETTLED_S: f64 = 20.0 * 86_400.0;
/// Seconds after which a state from before an event is too old to return to.
pub(super) const OUTDATED_S: f64 = 180.0 * 86_400.0;
