//! Constants of the detector: every number that it needs beside the tables of events, of causes
//! and of starting guesses, and beside the priors of a sound ship in [`crate::state_space`].
//!
//! Sources: "probability" is a law of probability; "study" is `cargo run --release --example
//! real_ships_study`, where the value is the cheapest beyond which the rows of sound ships and of
//! causes do not change; "assumed" is a judgement, with its reason; all else is a document.

/// Seconds of an hour and of a day.
pub(crate) const HOUR_S: f64 = 3600.0;
pub(crate) const DAY_S: f64 = 24.0 * HOUR_S;

// Readings.

/// Probability of a wild reading. Assumed: one in two days of samples.
pub(crate) const WILD: f64 = 0.004;
/// Uncertainty of the deviation from which a reading may teach so much that a wild one harms,
/// degrees. Study.
pub(crate) const OPEN_DEG: f64 = 0.7;
/// Ratio of a prediction's variance to the reading's from which it does. Study.
pub(crate) const TEACHES: f64 = 20.0;
/// Standard deviation of the share of a jump that lies within the row in which it happens,
/// degrees. Probability: about 5/√12, that of a jump of 5° at any time of the row.
pub(crate) const AMID_DEG: f64 = 1.5;
/// Standard deviation of the readings of an instrument that stands still, degrees. Assumed: half
/// degrees, rounded, and the shake of a jammed card.
pub(crate) const HELD_DEG: f64 = 0.3;
/// Greatest turn of an instrument that stood still, degrees. Probability: by
/// [`HELD_DEG`], fewer than one in 10⁵ pairs turn by more.
pub(crate) const STOOD_DEG: f64 = 2.0;
/// Least turn of a ship by which another instrument is seen to stand still, degrees. Assumed: more
/// than the means of samples on one course differ.
pub(crate) const TURNED_DEG: f64 = 10.0;

// Time.

/// Usual time between rows, seconds: a sample each ten minutes (`docs/agent.md`).
pub(crate) const ROW_S: f64 = 600.0;
pub(crate) const HOUR_ROWS: usize = (HOUR_S / ROW_S) as usize;
pub(crate) const DAY_ROWS: usize = 24 * HOUR_ROWS;
/// Rows of a week, after which it is known how a ship began. Her usual noise is known after two,
/// and the size of her habits after four.
pub(crate) const WEEK_ROWS: usize = 7 * DAY_ROWS;
/// Rows among which an event may be supposed: three days. Study.
pub(crate) const KEPT_ROWS: usize = 3 * DAY_ROWS;
/// Rows between the checkpoints of a kept state. Assumed: six hours, within which two events are
/// one.
pub(crate) const KEPT_CHECKPOINT_ROWS: usize = 6 * HOUR_ROWS;
/// Rows between looks for events. Study.
pub(crate) const LOOK_ROWS: usize = 2;
/// Time within which two events of a kind, or an event and the logbook's word of it, are one,
/// seconds. Assumed: a time that is written down later is wrong by a watch and a half.
pub(crate) const SAME_S: f64 = 6.0 * HOUR_S;
/// Time after an event within which people write down that they noticed, seconds. Assumed: the
/// day after, or the next.
pub(crate) const REPORTED_WITHIN_S: f64 = 2.0 * DAY_S;
/// Time after which an event is no longer judged, and has shown itself if there was one, seconds.
/// Study.
pub(crate) const SETTLED_S: f64 = 20.0 * DAY_S;
/// Time after which a state from before an event is too old to return to, seconds. Assumed:
/// cargo stays for half a year at most.
pub(crate) const OUTDATED_S: f64 = 180.0 * DAY_S;
/// Memories of a settling gyro after which it is right again. Probability: e⁻³, a twentieth, of
/// its error is left.
pub(crate) const SETTLED_MEMORIES: f64 = 3.0;
/// Port calls of a ship, a year. Assumed: a call a week.
pub(crate) const CALLS_A_YEAR: f64 = 50.0;

// Weights of hypotheses, natural logarithms.

/// Log weight within which two accounts are about as likely, and from which one more event is
/// worth a look. Probability: odds of fifty.
pub(crate) const UNCERTAIN: f64 = 4.0;
/// Log weight above all others' from which the lead may teach the ship's habits. Probability:
/// odds of twenty.
pub(crate) const CERTAIN: f64 = 3.0;
/// Log weight below the best's from which an account changes no result. Probability: odds of a
/// thousand.
pub(crate) const NEGLIGIBLE: f64 = 7.0;
/// Log weight below the best's at which an account is given up. Study.
pub(crate) const GIVEN_UP: f64 = 12.0;
/// Such a log weight for the likeliest account that supposes fewer events than the lead, passing
/// ones apart: on one course a storm can feign a strike, until the next turn. Study.
pub(crate) const SIMPLER_GIVEN_UP: f64 = 40.0;
/// Log weight by which an account has become better than before. Probability: odds of e; a lead
/// that changed for less would change back.
pub(crate) const BETTER: f64 = 1.0;
/// Accounts beside the lead under which an event is supposed, too. Study.
pub(crate) const ALTERNATIVES: usize = 3;
/// Most accounts. Study.
pub(crate) const MOST_HYPOTHESES: usize = 40;
/// Starts of an event between rows that are weighed at a time. Study.
pub(crate) const STARTS: usize = 2;
/// Difference of means in standard deviations up to which two accounts are alike. Probability: of
/// two such normal distributions 84 % is in common.
pub(crate) const ALIKE: f64 = 0.4;

// Innovations from which events are proposed.

/// Cost in squares of taking the noise for a disturbance's: twice the logarithm of the ratio of
/// standard deviations. Probability: a disturbance of e times the noise.
pub(crate) const WIDER_COST: f64 = 2.0;
/// Largest innovation that counts, standard deviations. Probability: one in 10⁹ sound readings
/// is beyond it, and by [`WILD`] one in 250 is wild.
pub(crate) const LARGEST_SD: f64 = 6.0;

// What is detected, and how it is reported.

/// False alarms that are allowed, a year: of the ship, of a reference, of what passes by and of the
/// compass. Assumed: a master who is called often for nothing does not come.
pub(crate) const FALSE_ALARMS_A_YEAR: [f64; 4] = [0.08, 0.1, 0.1, 0.02];
/// Probability from which a date or an end of an event is credible, and a cause is named.
/// Probability: odds of fifty.
pub(crate) const IMPROBABLE: f64 = 0.02;
/// Posterior probability below which a detected event is withdrawn. Assumed: not at every turn,
/// or the alarm would come and go.
pub(crate) const WITHDRAWN: f64 = 0.3;
/// Probability of what the logbook says, and from which the posterior is reported as a fact. Assumed:
/// one entry in ten is wrong.
pub(crate) const TRUSTED: f64 = 0.9;
/// Factor on the weight of a cause that people reported at the time. Assumed: of a hundred
/// reports of lightning, one is made up.
pub(crate) const REPORTED_FACTOR: f64 = 100.0;
/// Share of a disturbance's readings with a smaller error than the one that is reported: the largest
/// are wild. Probability: the upper quartile.
pub(crate) const SMALLER_SHARE: f64 = 0.75;
/// Innovation by which a change is detected, standard deviations. Probability: it outweighs an
/// event's prior in one hour of a year, and the detection threshold.
pub(crate) const DETECTED_SD: f64 = 5.0;
/// Step of the permanent magnetism that a watched vessel shows, nT: one that moves the compass by
/// five degrees, from which it must be adjusted (Marshall Islands MN 2-011-32).
pub(crate) const WATCHED_FOR_NT: f64 = 2000.0;

// Learning of a ship's habits.

/// Change of a level's logarithm by which the slope is taken, and the greatest step of it for one
/// row. Study.
pub(crate) const NUDGE: f64 = 0.05;
/// Greatest knowledge of a level's logarithm, one over its variance: habits change. Probability:
/// known to a twentieth.
pub(crate) const MOST_KNOWN: f64 = 400.0;
/// Most that one row teaches. Probability: as much as two readings of the level itself.
pub(crate) const MOST_TAUGHT: f64 = 4.0;
/// Number of days among which the brief levels are shared once a ship is known. Study: time a
/// vessel-year.
pub(crate) const TURNS: usize = 4;
