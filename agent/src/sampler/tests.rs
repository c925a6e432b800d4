//! The sampler on small simulated voyages.

use super::*;
use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading};
use binnacle_compass::sample::SourceId;
use binnacle_instruments::ReferenceHeading;
use proptest::prelude::*;

const START_S: i64 = 1_700_000_000;

fn at(seconds: i64) -> Timestamp {
    Timestamp::from_micros((START_S + seconds) * 1_000_000).unwrap()
}

fn place() -> Position {
    Position::new(43.0, -3.0).unwrap()
}

fn compass(degrees: f64) -> Signal {
    Signal::Compass(CompassHeading::new(degrees).unwrap())
}

fn gyro(degrees: f64) -> Signal {
    Signal::Gyro(reference(degrees, "gyro 1"))
}

fn reference(degrees: f64, source: &str) -> ReferenceHeading {
    ReferenceHeading {
        heading: TrueHeading::new(degrees).unwrap(),
        source: SourceId::from_name(source),
    }
}

/// One second of a vessel that steers by gyro and whose compass reads 3° less.
fn second(time_s: i64, heading_deg: f64) -> Vec<Signal> {
    vec![
        Signal::Time(at(time_s)),
        Signal::Position(place()),
        Signal::Speed(12.0),
        compass(heading_deg - 3.0),
        gyro(heading_deg),
    ]
}

fn sampler() -> Sampler {
    Sampler::new(Settings::default(), None)
}

fn feed(sampler: &mut Sampler, signals: impl IntoIterator<Item = Signal>) {
    for signal in signals {
        sampler.apply(signal);
    }
}

fn sail(sampler: &mut Sampler, seconds: std::ops::Range<i64>, heading: impl Fn(i64) -> f64) {
    for time in seconds {
        feed(sampler, second(time, heading(time)));
    }
}

fn finished(mut sampler: Sampler) -> (Vec<Sample>, Tally) {
    sampler.finish();
    (sampler.take_samples(), sampler.take_tally())
}

#[test]
fn a_steady_hour_settles_first_and_is_then_sampled_every_ten_minutes() {
    let mut sampler = sampler();
    sail(&mut sampler, 0..3601, |_| 1.0);
    let (samples, tally) = finished(sampler);
    assert_eq!(tally.count(Outcome::Settling), 19);
    assert_eq!(tally.count(Outcome::Accepted), 341);
    let windows: Vec<u16> = samples.iter().map(|s| s.windows).collect();
    assert_eq!(windows, [60, 60, 60, 60, 60, 41]);
    let first = &samples[0];
    assert_eq!(first.time, at(190 + 300));
    assert!((first.compass.degrees() - 358.0).abs() < 1e-9);
    assert!((first.gyro.unwrap().degrees() - 1.0).abs() < 1e-9);
    assert_eq!(first.satellite, None);
    assert!(first.spread_deg.unwrap() < 1e-9);
}

#[test]
fn nothing_is_sampled_beside_a_magnetic_pole() {
    let mut sampler = sampler();
    let pole = Position::new(-64.0, 136.0).unwrap();
    for time in 0..1200 {
        feed(&mut sampler, second(time, 1.0));
        sampler.apply(Signal::Position(pole));
    }
    let (samples, tally) = finished(sampler);
    assert_eq!(samples, []);
    assert_eq!(tally.count(Outcome::HighLatitude), 119);
}

#[test]
fn nothing_is_sampled_for_three_minutes_after_a_turn() {
    let mut sampler = sampler();
    let heading = |t: i64| 90.0 + 0.2 * (t - 1000).clamp(0, 200) as f64;
    sail(&mut sampler, 0..2001, heading);
    let (samples, tally) = finished(sampler);
    // The turn of 40° ends at 1200 s; the last 10° of it begin no later than 1150 s.
    let resumed = samples
        .iter()
        .find(|s| s.compass.degrees() > 120.0)
        .unwrap();
    let first_window = resumed.time.plus_seconds(-5.0 * f64::from(resumed.windows));
    assert!(first_window >= at(1330), "{first_window}");
    assert!(tally.count(Outcome::Settling) > 19 + 18);
    assert!(samples.iter().all(|s| s.spread_deg.unwrap_or(0.0) < 0.01));
}

#[test]
fn a_fast_turn_counts_as_turning_by_the_instrument_or_by_the_heading() {
    for with_instrument in [false, true] {
        let mut sampler = sampler();
        for time in 0..1000 {
            let turned = 0.5 * (time - 500).clamp(0, 15) as f64;
            feed(&mut sampler, second(time, 90.0 + turned));
            if with_instrument {
                let rate = if (500..515).contains(&time) {
                    30.0
                } else {
                    0.0
                };
                sampler.apply(Signal::RateOfTurn(rate));
            }
        }
        let (_, tally) = finished(sampler);
        assert!(
            tally.count(Outcome::Turning) >= 1,
            "instrument: {with_instrument}"
        );
        assert!(tally.count(Outcome::Settling) >= 19 + 18);
    }
}

#[test]
fn a_swing_beyond_two_degrees_either_way_is_refused() {
    for (amplitude, refused) in [(1.8, false), (2.4, true)] {
        let mut sampler = sampler();
        sail(&mut sampler, 0..601, |t| {
            90.0 + amplitude * (t as f64 / 3.0).sin()
        });
        let (_, tally) = finished(sampler);
        assert_eq!(tally.count(Outcome::Swinging) > 0, refused, "{amplitude}");
        assert_eq!(tally.count(Outcome::Accepted) > 0, !refused, "{amplitude}");
    }
}

#[test]
fn each_thing_that_is_missing_is_named() {
    type IsMissing = fn(&Signal) -> bool;
    let missing: [(IsMissing, Outcome); 4] = [
        (|s| matches!(s, Signal::Compass(_)), Outcome::NoCompass),
        (|s| matches!(s, Signal::Gyro(_)), Outcome::NoReference),
        (|s| matches!(s, Signal::Position(_)), Outcome::NoPosition),
        (|s| matches!(s, Signal::Speed(_)), Outcome::NoSpeed),
    ];
    for (is_missing, outcome) in missing {
        let mut sampler = sampler();
        for time in 0..601 {
            let heard = second(time, 90.0).into_iter().filter(|s| !is_missing(s));
            feed(&mut sampler, heard);
        }
        let (samples, tally) = finished(sampler);
        assert_eq!(
            (samples.len(), tally.count(outcome)),
            (0, 60),
            "{outcome:?}"
        );
    }
}

#[test]
fn slow_sparse_and_held_windows_are_named() {
    let mut slow = sampler();
    let mut sparse = sampler();
    for time in 0..601 {
        for signal in second(time, 90.0) {
            slow.apply(match signal {
                Signal::Speed(_) => Signal::Speed(3.9),
                other => other,
            });
            if time % 4 == 0 || !matches!(signal, Signal::Compass(_)) {
                sparse.apply(signal);
            }
        }
    }
    assert_eq!(finished(slow).1.count(Outcome::Slow), 60);
    assert_eq!(finished(sparse).1.count(Outcome::Sparse), 60);
    for exclusion in [
        Exclusion::Berthed,
        Exclusion::MagneticCargo,
        Exclusion::Degaussing,
    ] {
        let mut sampler = Sampler::new(Settings::default(), Some(exclusion));
        sail(&mut sampler, 0..601, |_| 90.0);
        let (samples, tally) = finished(sampler);
        assert_eq!((samples.len(), tally.count(exclusion.outcome())), (0, 60));
    }
}

#[test]
fn a_satellite_compass_that_says_invalid_is_absent() {
    let mut sampler = sampler();
    for time in 0..601 {
        feed(&mut sampler, second(time, 90.0));
        sampler.apply(Signal::Satellite(reference(170.0, "satellite")));
        sampler.apply(Signal::SatelliteInvalid);
    }
    let (samples, _) = finished(sampler);
    assert_eq!(samples.len(), 1);
    assert_eq!(samples[0].satellite, None);
}

#[test]
fn a_clock_that_jumps_voids_the_open_window_and_settles_anew() {
    let mut sampler = sampler();
    sail(&mut sampler, 0..605, |_| 90.0);
    sampler.apply(Signal::Jump(at(-9000)));
    sail(&mut sampler, -8999..-8400, |_| 90.0);
    let (samples, tally) = finished(sampler);
    assert_eq!(tally.count(Outcome::Clock), 1);
    assert!(tally.count(Outcome::Settling) >= 2 * 18);
    assert_eq!(samples.len(), 2);
    assert!(samples.iter().all(|s| s.windows > 30 && s.windows < 60));
}

#[test]
fn windows_without_a_time_stamp_are_counted_and_end_the_stretch() {
    let mut sampler = sampler();
    sail(&mut sampler, 0..600, |_| 90.0);
    sail(&mut sampler, 900..1500, |_| 90.0);
    let (samples, tally) = finished(sampler);
    assert_eq!(tally.count(Outcome::NoTime), 30);
    assert_eq!(samples.len(), 2);
}

fn course(degrees: f64) -> Signal {
    Signal::Course(CourseOverGround::new(degrees).unwrap())
}

#[test]
fn course_roll_and_temperature_come_with_the_headings() {
    let mut sampler = sampler();
    for time in 0..791 {
        feed(&mut sampler, second(time, 0.0));
        let phase = std::f64::consts::TAU * time as f64 / 10.0;
        feed(
            &mut sampler,
            [
                course(if time % 2 == 0 { 359.0 } else { 3.0 }),
                Signal::Roll(1.5 + 4.0 * phase.sin()),
                Signal::Roll(f64::NAN),
                Signal::Temperature(if time < 490 { 20.0 } else { 21.0 }),
            ],
        );
    }
    let (samples, _) = finished(sampler);
    let found = &samples[0];
    assert_eq!(found.windows, 60);
    assert!((found.cog.unwrap().degrees() - 1.0).abs() < 1e-6);
    assert!((found.roll_deg.unwrap() - 1.5).abs() < 1e-6);
    assert!((found.roll_spread_deg.unwrap() - 4.0 / 2_f64.sqrt()).abs() < 1e-6);
    assert!((found.temperature_c.unwrap() - 20.5).abs() < 1e-6);
    assert_eq!(found.gyro_source, Some(SourceId::from_name("gyro 1")));
    assert_eq!(found.satellite_source, None);
}

/// One second of a vessel with compass and GNSS receiver alone.
fn second_without_reference(time_s: i64) -> Vec<Signal> {
    let mut signals = second(time_s, 90.0);
    signals.pop();
    signals.push(course(94.0));
    signals
}

#[test]
fn a_ship_without_gyro_and_satellite_compass_is_sampled_by_her_course() {
    let mut sampler = sampler();
    for time in 0..7201 {
        feed(&mut sampler, second_without_reference(time));
    }
    let (samples, tally) = finished(sampler);
    assert_eq!(tally.count(Outcome::NoReference), 360);
    assert_eq!(tally.count(Outcome::Accepted), 360);
    let found = &samples[0];
    assert!((found.compass.degrees() - 87.0).abs() < 1e-9);
    assert!((found.cog.unwrap().degrees() - 94.0).abs() < 1e-9);
    assert_eq!((found.gyro, found.satellite), (None, None));
}

#[test]
fn a_gyro_that_is_off_for_half_an_hour_leaves_a_gap_and_no_courses() {
    let mut sampler = sampler();
    for time in 0..5401 {
        let mut signals = if (1800..3600).contains(&time) {
            second_without_reference(time)
        } else {
            second(time, 90.0)
        };
        signals.push(course(94.0));
        feed(&mut sampler, signals);
    }
    let (samples, tally) = finished(sampler);
    assert_eq!(tally.count(Outcome::NoReference), 180);
    assert!(samples.iter().all(|sample| sample.gyro.is_some()));
}

#[test]
fn a_sample_by_course_ends_where_the_gyro_is_read_again() {
    let mut sampler = sampler();
    for time in 0..4501 {
        let signals = if time < 4203 {
            second_without_reference(time)
        } else {
            second(time, 90.0)
        };
        feed(&mut sampler, signals);
    }
    let (samples, _) = finished(sampler);
    let last = samples.last().unwrap();
    assert_eq!((last.windows, last.cog), (30, None));
    let by_course = &samples[..samples.len() - 1];
    assert!(by_course.iter().all(|sample| sample.gyro.is_none()));
}

#[test]
fn what_no_instrument_gives_is_absent() {
    let mut sampler = sampler();
    sail(&mut sampler, 0..601, |_| 90.0);
    let (samples, _) = finished(sampler);
    let found = &samples[0];
    assert_eq!((found.cog, found.temperature_c), (None, None));
    assert_eq!((found.roll_deg, found.roll_spread_deg), (None, None));
}

#[test]
fn a_sample_ends_where_the_ship_goes_over_to_another_gyro() {
    let mut sampler = sampler();
    for time in 0..901 {
        let mut signals = second(time, 90.0);
        if time >= 603 {
            signals.pop();
            signals.push(Signal::Gyro(reference(91.0, "gyro 2")));
        }
        feed(&mut sampler, signals);
    }
    let (samples, tally) = finished(sampler);
    assert_eq!(tally.count(Outcome::Accepted), 71);
    let found: Vec<_> = samples
        .iter()
        .map(|s| (s.windows, s.gyro.unwrap().degrees(), s.gyro_source))
        .collect();
    let source = |name| Some(SourceId::from_name(name));
    assert_eq!(
        found,
        [(41, 90.0, source("gyro 1")), (30, 91.0, source("gyro 2"))]
    );
}

#[test]
fn settings_from_server_take_effect_at_once() {
    let mut sampler = sampler();
    sail(&mut sampler, 0..1000, |_| 90.0);
    sampler.set_settings(Settings {
        min_sog_kn: 14.0,
        ..Settings::default()
    });
    sail(&mut sampler, 1000..1200, |_| 90.0);
    assert!(finished(sampler).1.count(Outcome::Slow) >= 19);
}

#[test]
fn two_million_signals_take_about_a_second_even_unoptimised() {
    // A guard against a slip in the inner loop, not a measurement: see `replay`.
    let mut sampler = sampler();
    let before = std::time::Instant::now();
    sail(&mut sampler, 0..100_000, |t| 90.0 + (t as f64 / 7.0).sin());
    assert!(before.elapsed().as_secs_f64() < 5.0);
    assert!(finished(sampler).0.len() > 100);
}

fn any_signal() -> impl Strategy<Value = Signal> {
    let time = prop_oneof![-200_000_i64..200_000, -4_000_000_000_i64..4_000_000_000];
    let instant = time.prop_map(|s| Timestamp::from_micros((START_S + s) * 1_000_000).unwrap());
    prop_oneof![
        instant.clone().prop_map(Signal::Time),
        (0_i64..300).prop_map(|s| Signal::Time(at(s))),
        instant.prop_map(Signal::Jump),
        (0.0..360.0).prop_map(compass),
        (0.0..360.0).prop_map(gyro),
        Just(Signal::GyroInvalid),
        Just(Signal::SatelliteInvalid),
        Just(Signal::Position(place())),
        any::<f64>().prop_map(Signal::Speed),
        any::<f64>().prop_map(Signal::RateOfTurn),
        (0.0..360.0).prop_map(course),
        any::<f64>().prop_map(Signal::Roll),
        any::<f64>().prop_map(Signal::Temperature),
    ]
}

proptest! {
    #[test]
    fn no_order_of_signals_breaks_it(signals in prop::collection::vec(any_signal(), 0..400)) {
        let mut sampler = sampler();
        feed(&mut sampler, signals);
        let (samples, tally) = finished(sampler);
        let windows: u64 = samples.iter().map(|s| u64::from(s.windows)).sum();
        prop_assert!(windows <= tally.count(Outcome::Accepted));
        for sample in samples {
            prop_assert!(sample.windows >= 1);
            prop_assert!(sample.gyro.is_some() || sample.satellite.is_some());
            prop_assert_eq!(sample.gyro.is_some(), sample.gyro_source.is_some());
            prop_assert_eq!(binnacle_wire::codec::check(&sample, 0), Ok(()));
        }
    }

    #[test]
    fn the_difference_holds_on_every_heading(heading in 0.0..360.0_f64, lead in -40.0..40.0_f64) {
        let mut sampler = sampler();
        for time in 0..800 {
            let yaw = (time as f64 / 5.0).sin();
            sampler.apply(Signal::Time(at(time)));
            sampler.apply(Signal::Position(place()));
            sampler.apply(Signal::Speed(12.0));
            sampler.apply(compass(heading + yaw + lead));
            sampler.apply(gyro(heading + yaw));
        }
        let (samples, _) = finished(sampler);
        prop_assert!(!samples.is_empty());
        for sample in samples {
            let found = wrap_180(sample.compass.degrees() - sample.gyro.unwrap().degrees());
            prop_assert!((found - lead).abs() < 1e-6, "{found} {lead}");
        }
    }
}
