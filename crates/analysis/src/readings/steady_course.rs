//! Samples whose course over ground shows no heading: of a ship that drifts, or turns.
//!
//! Course over ground is the heading plus a drift angle: current across the course over the
//! speed. Near standstill that angle may be anything, and in a turn the ship skids.

use super::reading::Reading;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::result::SampleReason;
use binnacle_compass::sample::Sample;

/// Least speed over ground, knots: a current of a knot across turns the course by 14 degrees.
pub const LEAST_SOG_KN: f64 = 4.0;
/// Greatest mean rate of turn of a straight run, degrees a minute: at 12 knots a ship of 200 m
/// skids by 0.2 degrees (0.4 of her length over the radius of the turn).
const STRAIGHT_DEG_MIN: f64 = 1.0;
/// Change of course from which a sample lies in a turn or just after one, degrees, and greatest
/// time in seconds since the sample before, which may have been on another course.
const TURNED_DEG: f64 = 10.0;
const AFTER_TURN_S: f64 = 900.0;

/// Marks the samples that their course over ground cannot stand for, in order of time.
pub fn mark_unsteady_courses(readings: &mut [Reading]) {
    let mut last: Option<Sample> = None;
    for reading in readings {
        let sample = *reading.sample();
        let reason = &mut reading.diagnostic.reason;
        *reason = reason.or(unsteady(&sample, last.as_ref()));
        last = Some(sample);
    }
}

/// Returns the reason for which a sample's course over ground shows no heading, if any.
fn unsteady(sample: &Sample, last: Option<&Sample>) -> Option<SampleReason> {
    let is_slow = sample.sog_kn.is_none_or(|sog_kn| sog_kn < LEAST_SOG_KN);
    let rate = sample.rate_of_turn_deg_min.unwrap_or(0.0);
    let is_turning =
        rate.abs() > STRAIGHT_DEG_MIN || last.is_some_and(|last| has_turned(last, sample));
    if is_slow {
        Some(SampleReason::TooSlowForCourse)
    } else {
        is_turning.then_some(SampleReason::TurningCourse)
    }
}

/// Returns true for a turn between two samples that follow each other closely.
fn has_turned(a: &Sample, b: &Sample) -> bool {
    let by_compass = wrap_180(b.compass.degrees() - a.compass.degrees());
    let by_course = a.cog.zip(b.cog);
    let by_course = by_course.map_or(0.0, |(a, b)| wrap_180(b.degrees() - a.degrees()));
    b.time.seconds_since(a.time) < AFTER_TURN_S
        && by_compass.abs().max(by_course.abs()) > TURNED_DEG
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::angle::{CompassHeading, CourseOverGround};
    use binnacle_compass::position::Position;
    use binnacle_compass::time::Timestamp;

    fn sample(seconds: f64, deg: f64, sog_kn: f64) -> Sample {
        let start = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        let position = Position::new(43.0, -3.0).unwrap();
        let compass = CompassHeading::new(deg).unwrap();
        Sample {
            cog: CourseOverGround::new(deg),
            sog_kn: Some(sog_kn),
            rate_of_turn_deg_min: Some(0.0),
            ..Sample::new(start.plus_seconds(seconds), position, compass)
        }
    }

    #[test]
    fn a_drifting_ship_shows_no_heading() {
        let slow = Some(SampleReason::TooSlowForCourse);
        assert_eq!(unsteady(&sample(0.0, 90.0, 1.5), None), slow);
        assert_eq!(unsteady(&sample(0.0, 90.0, 10.0), None), None);
    }

    #[test]
    fn a_turn_and_the_first_sample_after_one_show_no_heading() {
        let turning = Some(SampleReason::TurningCourse);
        let before = sample(0.0, 90.0, 10.0);
        assert_eq!(
            unsteady(&sample(600.0, 120.0, 10.0), Some(&before)),
            turning
        );
        assert_eq!(unsteady(&sample(600.0, 94.0, 10.0), Some(&before)), None);
        assert_eq!(unsteady(&sample(7200.0, 120.0, 10.0), Some(&before)), None);
        let skidding = Sample {
            rate_of_turn_deg_min: Some(-3.0),
            ..before
        };
        assert_eq!(unsteady(&skidding, None), turning);
    }
}
