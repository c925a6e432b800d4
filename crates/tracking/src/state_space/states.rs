//! States of the filter: the ship, her compass, the field's error and the references.
//!
//! Ship's parameters are in units of the population's standard deviations, all else in the
//! units named here.
//!
//! The states from [`REFERENCE`] on are the errors of the reference. A voyage with gyro or
//! satellite compass has those of the instruments, one without has those of the course over
//! ground in the same places: no voyage has both.

use binnacle_analysis::estimate::POPULATION_SD;
use binnacle_compass::model::Parameters;
use binnacle_compass::ship::PARAMETERS;

/// Number of states.
pub(crate) const STATES: usize = 34;

/// Fore-and-aft permanent field; the other six parameters follow in the order of
/// [`Parameters`].
pub(crate) const BX: usize = 0;
/// Athwartship permanent field.
pub(crate) const BY: usize = 2;
/// Retained share of the induced field, per cent, of each memory in [`RETENTION_S`].
pub(crate) const RETENTION: usize = 7;
/// Athwartship field of a heel, in units of [`HEEL_NT_PER_RAD`].
pub(crate) const HEEL: usize = 9;
/// Athwartship field of an unmeasured list, in units of [`LIST_NT`].
pub(crate) const LIST: usize = 10;
/// Alignment of the compass, degrees: added to every deviation.
pub(crate) const ALIGNMENT: usize = 11;
/// Slow swing of the card, degrees.
pub(crate) const SWING: usize = 12;
/// Friction of the card on the present course, degrees where H is [`USUAL_H_NT`].
pub(crate) const FRICTION: usize = 13;
/// Error of the charted variation, degrees where H is [`USUAL_H_NT`].
pub(crate) const VARIATION: usize = 14;
/// Daily wave of the variation by local time, sine and cosine, as above.
pub(crate) const DAILY: usize = 15;
/// First state of the reference's errors.
const REFERENCE: usize = 17;
/// Constant error of the gyro, degrees.
pub(crate) const GYRO: usize = REFERENCE;
/// Slow wander of the gyro's settling point, degrees at the equator.
pub(crate) const GYRO_SLOW: usize = 18;
/// Schuler swing of the gyro and its rate, degrees at the equator.
pub(crate) const SCHULER: usize = 19;
/// Share of the gyro's speed error that is left in the reading.
pub(crate) const SPEED: usize = 21;
/// Heading-dependent error of the gyro, sine and cosine, degrees.
pub(crate) const GYRO_HEADING: usize = 22;
/// Error of a gyro that settles after a start or a shock, degrees.
pub(crate) const SETTLING: usize = 24;
/// Constant error of the satellite compass, degrees.
pub(crate) const SATELLITE: usize = 25;
/// Slow error of the satellite compass by reflections, degrees.
pub(crate) const REFLECTION: usize = 26;
/// Lag of the references, minutes.
pub(crate) const LAG: usize = 27;
/// Local anomaly of the variation and its rate in its memory, degrees.
pub(crate) const ANOMALY: usize = 28;

/// Growth of the permanent field fore and aft a day; athwartships follows.
pub(crate) const GROWTH: usize = 30;

/// Direction of the induced field at the last berth, in ship axes and over H: nobody reads the
/// heading there.
pub(crate) const BERTH: usize = 32;

/// Constant drift angle of a ship without heading reference, degrees: propeller, rudder, trim.
pub(crate) const CRAB: usize = REFERENCE;
/// Current to the east and its rate, and to the north and its rate, knots.
pub(crate) const CURRENT: usize = REFERENCE + 1;
/// Leeway as a drift by the weather's wind to the east and to the north, knots.
pub(crate) const LEEWAY: usize = REFERENCE + 5;
/// Steady drift by prevailing winds and residual currents to the east and to the north, knots.
pub(crate) const STEADY: usize = REFERENCE + 7;

/// Memories of retained magnetism, seconds: hours to days on a steady course (NGA Pub. 226).
pub(crate) const RETENTION_S: [f64; 2] = [4.0 * 3600.0, 16.0 * 3600.0];
/// Heeling field of a usual ship, nT per radian of heel. Assumed: an eighth of the earth's vertical
/// field in mid-latitudes.
pub(crate) const HEEL_NT_PER_RAD: f64 = 5000.0;
/// Unit of the list's field, nT.
pub(crate) const LIST_NT: f64 = 100.0;
/// Horizontal field for which errors of card and variation are given, nT.
pub(crate) const USUAL_H_NT: f64 = 24_000.0;

/// Returns the ship's parameters of a mean.
pub(crate) fn parameters(mean: &[f64; STATES]) -> Parameters {
    Parameters::from_array(std::array::from_fn(|j| mean[j] * POPULATION_SD[j]))
}

/// Returns the product of two vectors, in two independent sums.
pub(crate) fn dot(a: &[f64; STATES], b: &[f64; STATES]) -> f64 {
    let mut sums = [0.0; 2];
    for (a, b) in a.as_chunks::<2>().0.iter().zip(b.as_chunks::<2>().0) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    sums[0] + sums[1]
}

const _: () = assert!(STEADY + 1 < LAG);
const _: () = assert!(RETENTION == PARAMETERS);
