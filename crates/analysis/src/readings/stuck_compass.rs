//! Stuck compass: a jammed card, or a sensor that repeats itself, while the vessel turns.
//!
//! Wild readings of a reference are no turn, and a compass that follows half of a turn is
//! free. Turns are measured against magnetic north, because a vessel steered by its compass
//! keeps the reading constant while the variation changes. Readings on a steady course
//! before the first turn are not marked unless they are identical.

use super::reading::Reading;
use binnacle_compass::angle::{TrueHeading, Variation, wrap_180};
use binnacle_compass::result::{Cause, CauseProbability, Change, SampleReason};
use binnacle_compass::sample::Sample;
use std::ops::Range;

/// Difference up to which readings count as identical. A sound compass wanders by more
/// between two means of ten minutes on a steady course.
const SAME_DEG: f64 = 0.15;
/// Greatest oscillation of a jammed card about its position; a sound one on a steady course
/// does no more.
const OSCILLATION_DEG: f64 = 1.0;
/// Jump, or number of readings elsewhere in a row, by which a card has left its position.
const JUMPS_DEG: f64 = 2.5;
const LEFT_READINGS: usize = 3;
/// Smallest turn by gyro or satellite compass, and the number of turns that show that a
/// constant reading does not follow. A reference that steps and returns makes two.
const TURN_DEG: f64 = 5.0;
const TURNS: usize = 3;
/// Share of a turn from which the compass follows. A sound compass turns least, by 1/(1 +
/// B) of it, on one heading: two thirds where B is 0.5.
const FOLLOWED_SHARE: f64 = 0.5;
/// Error, beyond the differences between headings, of a card that jammed in a turn.
const JAMMED_IN_TURN_DEG: f64 = 15.0;
/// Turn before that, which a jammed card did not follow.
const SLIGHT_TURN_DEG: f64 = 1.5;
/// Readings that a course must be kept for by all references, where the card oscillates:
/// wild readings come singly. No strike coincides with a turn and undoes it, so that one
/// turn by two references suffices. By one reference more turns are needed, because it may
/// be the one that errs, also while the other is silent.
const COURSE_READINGS: usize = 3;
const TURNS_BY_ONE: usize = 4;

/// Marks the readings of a stuck compass, and returns a change for each fault.
pub fn mark_stuck(readings: &mut [Reading]) -> Vec<Change> {
    let mut changes = Vec::new();
    let mut from = 0;
    let mut next_check = 0;
    while from < readings.len() {
        let mut found = None;
        if from >= next_check {
            let stood = readings_about_mean(&readings[from..]);
            found = oscillating(readings, from..from + stood);
            // What holds for all holds for the later readings, too: skipping them keeps the
            // work from growing with the square.
            next_check = from + stood.div_ceil(2);
        }
        let identical = from..from + identical(&readings[from..]);
        let found = found.or_else(|| repeating(readings, identical.clone()));
        from = identical.end;
        if let Some(stuck) = found {
            changes.push(stuck_change(readings, &stuck));
            from = stuck.all.end.max(from);
            for reading in &mut readings[stuck.all] {
                let reason = &mut reading.diagnostic.reason;
                *reason = reason.or(Some(SampleReason::CompassStuck));
            }
        }
    }
    changes
}

/// Readings of a compass that did not follow the vessel.
struct Stuck {
    all: Range<usize>,
    /// Reading that showed the fault.
    shown_at: usize,
    turns: usize,
    oscillates: bool,
}

/// Returns the fault of a compass with identical readings, if the vessel turned often.
fn repeating(readings: &[Reading], identical: Range<usize>) -> Option<Stuck> {
    let turns = || turns(&readings[identical.clone()]);
    let shown_at = identical.start + turns().nth(TURNS - 1)?;
    Some(Stuck {
        shown_at,
        turns: turns().count(),
        oscillates: false,
        all: identical,
    })
}

/// Returns the number of identical readings from the first on.
fn identical(readings: &[Reading]) -> usize {
    let off = |reading: &Reading| apart_deg(&readings[0], reading);
    readings
        .iter()
        .position(|reading| off(reading) > SAME_DEG)
        .unwrap_or(readings.len())
}

fn apart_deg(a: &Reading, b: &Reading) -> f64 {
    wrap_180(b.sample().compass.degrees() - a.sample().compass.degrees()).abs()
}

/// Returns the fault of a compass that oscillates about one heading, if the vessel kept
/// several courses.
fn oscillating(readings: &[Reading], stands: Range<usize>) -> Option<Stuck> {
    let stood = &readings[stands.clone()];
    let courses = courses(stood);
    let course = |first: usize| &stood[first..first + COURSE_READINGS];
    let by_both = courses
        .windows(2)
        .position(|pair| turned_deg(course(pair[0]), course(pair[1])).count() == 2);
    let enough = by_both.map_or(TURNS_BY_ONE, |turn| TURNS_BY_ONE.min(turn + 1));
    let shown_at = stands.start + courses.get(enough)? + COURSE_READINGS - 1;
    // On the first course it may have been sound.
    let mut first = stands.start + courses[1];
    let (course, turned) = (&stood[courses[0]], first);
    let is_stuck = |k: usize| {
        left_reference(SLIGHT_TURN_DEG, course, &readings[k])
            || apart_deg(&readings[turned], &readings[k]) < SAME_DEG
    };
    let before = (stands.start..first).rev().take_while(|&k| is_stuck(k));
    first = before.last().unwrap_or(first);
    let sound = stands.start.checked_sub(1).map(|k| &readings[k]);
    if sound.is_some_and(|sound| left_reference(JAMMED_IN_TURN_DEG, sound, course)) {
        first = stands.start;
    }
    // Readings from before the jam do not affect the jammed position.
    let end = stands
        .end
        .max(first + readings_about_mean(&readings[first..]));
    let kept = self::courses(&readings[first..end]).len();
    Some(Stuck {
        all: first..end,
        shown_at,
        turns: kept.max(courses.len() - 1),
        oscillates: (first..end).any(|k| apart_deg(&readings[first], &readings[k]) > SAME_DEG),
    })
}

/// Returns the number of readings, from the first on, that stay about their mean.
fn readings_about_mean(readings: &[Reading]) -> usize {
    let first = readings[0].sample().compass.degrees();
    let mut sum = 0.0;
    // First of the readings that have left the mean.
    let mut left = None;
    for (count, reading) in readings.iter().enumerate().skip(1) {
        let off = wrap_180(reading.sample().compass.degrees() - first);
        let from_mean = (off - sum / count as f64).abs();
        if from_mean > OSCILLATION_DEG {
            let since = *left.get_or_insert(count);
            if from_mean > JUMPS_DEG || count + 1 - since >= LEFT_READINGS {
                return since;
            }
        } else {
            left = None;
        }
        sum += off;
    }
    left.unwrap_or(readings.len())
}

/// Returns the first readings of the courses kept, each after a turn that the compass did
/// not follow.
fn courses(readings: &[Reading]) -> Vec<usize> {
    let mut begun: Vec<usize> = Vec::new();
    let mut since = 0;
    for k in 1..readings.len() {
        if has_turned(&readings[since..=since], &readings[k..=k]) {
            since = k;
        }
        let is_kept = k + 1 == since + COURSE_READINGS;
        let course = |first: usize| &readings[first..first + COURSE_READINGS];
        let is_another = |last: &usize| {
            let (last, next) = (course(*last), course(since));
            has_turned(last, next) && !has_followed(last, next)
        };
        if is_kept && begun.last().is_none_or(is_another) {
            begun.push(since);
        }
    }
    begun
}

/// Returns true if every reference read at all times shows a turn to the same side between
/// some readings and others, and at least one does.
fn has_turned(from: &[Reading], to: &[Reading]) -> bool {
    let mut turned = turned_deg(from, to);
    let first = turned.next();
    first.is_some_and(|first| {
        let agrees = |deg: f64| deg * first.signum() > TURN_DEG;
        agrees(first) && turned.all(agrees)
    })
}

/// Returns true if the compass followed the turn by any reference.
fn has_followed(from: &[Reading], to: &[Reading]) -> bool {
    let compass_deg = apart(from, to, |a, b| {
        Some(b.sample().compass.degrees() - a.sample().compass.degrees())
    });
    compass_deg.is_some_and(|compass_deg| {
        let goes_with = |deg: f64| compass_deg * deg.signum() > FOLLOWED_SHARE * deg.abs();
        turned_deg(from, to).any(goes_with)
    })
}

/// Returns the turns against magnetic north by each reference read at all times, degrees.
fn turned_deg(from: &[Reading], to: &[Reading]) -> impl Iterator<Item = f64> {
    let references: [fn(&Sample) -> Option<TrueHeading>; 2] = [|s| s.gyro, |s| s.satellite];
    let turned = references.map(|of| {
        apart(from, to, |a, b| {
            let (x, y) = of(a.sample()).zip(of(b.sample()))?;
            Some(y.degrees() - x.degrees() - varied_deg(a, b))
        })
    });
    turned.into_iter().flatten()
}

/// Returns the difference between the medians of an angle in two groups of readings,
/// degrees; none unless every reading has it.
fn apart(
    from: &[Reading],
    to: &[Reading],
    angle_deg: impl Fn(&Reading, &Reading) -> Option<f64>,
) -> Option<f64> {
    let first = from.first()?;
    let middle = |of: &[Reading]| {
        let angles = of.iter().map(|one| angle_deg(first, one).map(wrap_180));
        let mut angles = angles.collect::<Option<Vec<f64>>>()?;
        angles.sort_by(f64::total_cmp);
        angles.get(angles.len() / 2).copied()
    };
    Some(wrap_180(middle(to)? - middle(from)?))
}

/// Returns the change of the variation; zero where it is not known.
fn varied_deg(a: &Reading, b: &Reading) -> f64 {
    let degrees = Variation::degrees_east;
    let both = a.variation.zip(b.variation);
    both.map_or(0.0, |(a, b)| degrees(b) - degrees(a))
}

/// Returns true if the difference of compass and reference changed by more.
fn left_reference(degrees: f64, a: &Reading, b: &Reading) -> bool {
    let off = |reading: &Reading| {
        let sample = reading.sample();
        let reference = sample.satellite.or(sample.gyro)?.degrees();
        Some(reference - sample.compass.degrees())
    };
    let parted = off(a).zip(off(b));
    let parted = parted.map(|(x, y)| wrap_180(y - x - varied_deg(a, b)));
    parted.is_some_and(|parted| parted.abs() > degrees)
}

/// Returns the second reading after each turn: a reference that is wild for one reading has
/// recovered by then.
fn turns(readings: &[Reading]) -> impl Iterator<Item = usize> {
    let turned = |k: usize| has_turned(&readings[k - 1..k], &readings[k..=k]);
    let is_turn = move |k: usize| turned(k) && !turned(k + 1) && (k == 1 || !turned(k - 1));
    (1..readings.len().saturating_sub(1))
        .filter(move |&k| is_turn(k))
        .map(|k| k + 1)
}

fn stuck_change(readings: &[Reading], found: &Stuck) -> Change {
    let stuck = &found.all;
    let from = readings[stuck.start].sample().time;
    let last = readings[stuck.end - 1].sample().time;
    let before = stuck
        .start
        .checked_sub(1)
        .map(|i| readings[i].sample().time);
    let heading = readings[stuck.start].sample().compass.degrees();
    Change {
        from,
        from_earliest: before.unwrap_or(from),
        from_latest: from,
        detected_at: readings[found.shown_at].sample().time,
        confirmed: true,
        position: None,
        disturbed_deg: None,
        withdrawn: false,
        cause: Cause::CompassFault,
        causes: vec![CauseProbability {
            cause: Cause::CompassFault,
            probability: 1.0,
        }],
        evidence: vec![format!(
            "the compass {} {heading:.1} degrees in {} samples in a row while the vessel turned {} \
             times by gyro or satellite compass",
            if found.oscillates {
                "stayed near"
            } else {
                "read"
            },
            stuck.len(),
            found.turns
        )],
        deviation_change_deg: None,
        step: None,
        ended: (stuck.end < readings.len()).then_some(last),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readings::reading::readings;
    use binnacle_compass::model::ReferenceGrade;
    use binnacle_compass::settings::AnalysisSettings;
    use binnacle_compass::time::Timestamp;

    /// Readings ten minutes apart at 47 degrees north and the longitude given, by compass,
    /// gyro and satellite compass.
    fn shown(each: impl Iterator<Item = (f64, [f64; 3])>, has_satellite: bool) -> Vec<Reading> {
        let start = Timestamp::parse("2026-06-01T00:00:00Z").unwrap();
        let sample = |(k, (lon, [compass, gyro, satellite])): (usize, (f64, [f64; 3]))| {
            let satellite = Some(satellite).filter(|_| has_satellite);
            let sample = serde_json::json!({
                "time": start.plus_seconds(600.0 * k as f64), "lat": 47.0, "lon": lon,
                "compass_deg": compass, "gyro_deg": gyro, "satellite_deg": satellite,
                "sog_kn": 14.0, "rate_of_turn_deg_min": 0.0, "spread_deg": 0.3, "windows": 60,
            });
            serde_json::from_value(sample).unwrap()
        };
        let samples: Vec<Sample> = each.enumerate().map(sample).collect();
        readings(
            &samples,
            &[],
            &AnalysisSettings::default(),
            ReferenceGrade::Heading,
        )
    }

    #[test]
    fn a_compass_that_she_is_steered_by_stands_still_while_the_variation_changes() {
        // Westward over the Atlantic for five days.
        let steered = |compass_deg: f64| {
            let at = |k: u32| (-10.0 - f64::from(k) / 24.0, [compass_deg; 3]);
            let mut steered = shown((0..720).map(at), true);
            for reading in &mut steered {
                let true_deg = compass_deg + reading.variation.unwrap().degrees_east();
                let sample = &mut reading.diagnostic.sample;
                (sample.gyro, sample.satellite) =
                    (TrueHeading::new(true_deg), TrueHeading::new(true_deg));
            }
            steered
        };
        let mut steered = steered(280.0);
        let variation_deg = |k: usize| steered[k].variation.unwrap().degrees_east();
        assert!((variation_deg(719) - variation_deg(0)).abs() > TURN_DEG);
        assert_eq!(mark_stuck(&mut steered), []);
    }

    #[test]
    fn a_ship_that_yaws_about_her_course_has_no_stuck_compass() {
        let yaw_deg = |k: usize| match k {
            0 => -2.0,
            40 => 3.2,
            41.. => 0.4,
            _ => 0.0,
        };
        // The compass follows, but for the vessel's magnetism.
        let at = |k: usize| {
            let yaw_deg = yaw_deg(k);
            let compass_deg = 44.0 + if yaw_deg > 0.5 { 2.2 } else { 0.8 * yaw_deg };
            (-10.0, [compass_deg, 52.0 + yaw_deg, 52.0 + yaw_deg])
        };
        assert_eq!(mark_stuck(&mut shown((0..60).map(at), true)), []);
        // A jammed compass is found by the same turn, if the vessel keeps to it.
        let jams = |k: usize| {
            let yaw_deg = if k < 40 { 0.0 } else { 6.0 };
            (-10.0, [44.0, 52.0 + yaw_deg, 52.0 + yaw_deg])
        };
        assert_eq!(mark_stuck(&mut shown((0..60).map(jams), true)).len(), 1);
    }

    #[test]
    fn whole_degrees_on_a_steady_course_are_no_stuck_compass_though_a_reference_is_wild() {
        for has_satellite in [false, true] {
            let at = |k: usize| {
                let wild_deg = if k % 11 == 5 { 12.0 } else { 0.0 };
                (-10.0, [90.0, 85.0 + wild_deg, 85.0])
            };
            let mut steady = shown((0..120).map(at), has_satellite);
            assert_eq!(mark_stuck(&mut steady), [], "{has_satellite}");
            // A sensor that repeats itself on other courses is stuck.
            let turns = |k: usize| (-10.0, [90.0, 85.0 + [0.0, 30.0][k / 5 % 2], 85.0]);
            let mut turning = shown((0..40).map(turns), false);
            assert_eq!(mark_stuck(&mut turning).len(), 1);
        }
    }
}
