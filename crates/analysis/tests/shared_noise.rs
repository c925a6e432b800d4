//! References that are the compass's own are refused, and independent ones pass.

#![allow(clippy::unwrap_used)] // all of this is tests

use binnacle_analysis::fit::{HeadingPair, check_independence, weigh_independence};
use binnacle_compass::angle::{CompassHeading, TrueHeading, Variation};
use binnacle_compass::position::Position;
use binnacle_compass::result::FitError;
use binnacle_compass::time::Timestamp;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

fn gauss(rng: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (rng.random(), rng.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
}

fn rounded(angle: f64, digit: f64) -> f64 {
    if digit > 0.0 {
        (angle / digit).round() * digit
    } else {
        angle
    }
}

/// A passage of some courses, each with some rows about it.
struct Passage {
    courses: u32,
    rows_each: u32,
    seconds: f64,
    yaw_deg: f64,
}

const SWING: Passage = Passage {
    courses: 60,
    rows_each: 1,
    seconds: 600.0,
    yaw_deg: 1.0,
};
const LONG_SWING: Passage = Passage {
    courses: 120,
    ..SWING
};
const VOYAGE: Passage = Passage {
    courses: 25,
    rows_each: 20,
    seconds: 600.0,
    yaw_deg: 1.0,
};
const EVERY_SECOND: Passage = Passage {
    courses: 12,
    rows_each: 60,
    seconds: 1.0,
    yaw_deg: 2.0,
};

const PASSAGE: Passage = Passage {
    courses: 120,
    rows_each: 12,
    seconds: 600.0,
    yaw_deg: 1.0,
};
const LONG_COURSES: Passage = Passage {
    courses: 60,
    rows_each: 600,
    seconds: 1.0,
    yaw_deg: 2.0,
};

/// Compass of a ship.
struct Instruments {
    compass_digit: f64,
    compass_noise_deg: f64,
    deviation_deg: f64,
}

/// Readings of one moment, from which a reference is made.
struct Moment<'a> {
    true_deg: f64,
    variation_deg: f64,
    raw_deg: f64,
    shown_deg: f64,
    /// Compass as shown so far, the latest last, and the number of rows on this course.
    shown: &'a [f64],
    on_course: usize,
    rng: &'a mut ChaCha8Rng,
}

fn pairs(
    seed: u64,
    passage: &Passage,
    instruments: &Instruments,
    reference: impl Fn(&mut Moment<'_>) -> f64,
) -> Vec<HeadingPair> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let start = Timestamp::parse("2026-03-01T00:00:00Z").unwrap();
    let mut pairs = Vec::new();
    let mut row = 0.0;
    let mut shown = Vec::new();
    for _ in 0..passage.courses {
        let course = 360.0 * rng.random::<f64>();
        for on_course in 1..=passage.rows_each {
            // A yaw of half a minute.
            let phase = TAU * row * passage.seconds / 30.0 + 0.7 * row;
            let true_deg = course + passage.yaw_deg * phase.sin() * (0.5 + rng.random::<f64>());
            // Ten minutes since the start.
            let tens = row * passage.seconds / 600.0;
            let variation_deg = -3.0 + 6.0 * (tens / 400.0);
            let magnetic: f64 = true_deg - variation_deg;
            let deviation = instruments.deviation_deg * (magnetic + 30.0).to_radians().sin();
            let raw_deg = magnetic - deviation + instruments.compass_noise_deg * gauss(&mut rng);
            let shown_deg = rounded(raw_deg, instruments.compass_digit);
            shown.push(shown_deg);
            let reference_deg = reference(&mut Moment {
                true_deg,
                variation_deg,
                raw_deg,
                shown_deg,
                shown: &shown,
                on_course: on_course as usize,
                rng: &mut rng,
            });
            pairs.push(HeadingPair {
                time: Some(start.plus_seconds(row * passage.seconds)),
                position: Some(Position::new(20.0 + tens / 100.0, -30.0).unwrap()),
                compass: CompassHeading::new(shown_deg).unwrap(),
                reference: TrueHeading::new(reference_deg).unwrap(),
                variation: Variation::new(variation_deg).unwrap(),
                sog_kn: Some(12.0),
            });
            row += 1.0;
        }
    }
    pairs
}

const ADJUSTED: f64 = 0.3;

fn instruments(compass_digit: f64) -> Instruments {
    Instruments {
        compass_digit,
        compass_noise_deg: 0.25,
        deviation_deg: ADJUSTED,
    }
}

fn assert_refused(name: &str, pairs: &[HeadingPair]) {
    let checked = check_independence(pairs);
    assert!(
        matches!(checked, Err(FitError::ReferenceIsCompass { .. })),
        "{name}: {checked:?}"
    );
}

#[test]
fn independent_instruments_pass_whatever_their_digits_and_deviation() {
    for (name, passage) in [
        ("swing", &SWING),
        ("voyage", &VOYAGE),
        ("seconds", &EVERY_SECOND),
    ] {
        for compass_digit in [0.0, 0.1, 0.5, 1.0] {
            for reference_digit in [0.0, 0.1, 1.0] {
                for (deviation_deg, noise_deg) in
                    [(0.0, 0.15), (ADJUSTED, 0.07), (ADJUSTED, 0.3), (12.0, 0.3)]
                {
                    for seed in 0..8 {
                        let instruments = Instruments {
                            compass_digit,
                            compass_noise_deg: noise_deg,
                            deviation_deg,
                        };
                        let pairs = pairs(seed, passage, &instruments, |m| {
                            rounded(m.true_deg + noise_deg * gauss(m.rng), reference_digit)
                        });
                        let checked = check_independence(&pairs);
                        assert!(
                            checked.is_ok(),
                            "{name} {compass_digit} {reference_digit} {deviation_deg} \
                             {noise_deg} {seed}: {checked:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_real_reference_with_a_tenth_of_a_degree_of_scatter_passes() {
    for seed in 0..50 {
        let still = Instruments {
            compass_noise_deg: 0.0,
            ..instruments(0.1)
        };
        for passage in [&SWING, &VOYAGE, &EVERY_SECOND] {
            let pairs = pairs(seed, passage, &still, |m| {
                rounded(m.true_deg + 0.1 * gauss(m.rng), 0.1)
            });
            let checked = check_independence(&pairs);
            assert!(checked.is_ok(), "{seed}: {checked:?}");
        }
    }
}

#[test]
fn a_copy_of_the_compass_is_refused_in_any_digits() {
    for seed in 0..20 {
        // A second rounding to whole degrees leaves a third of a nat a row.
        for (passage, longer) in [
            (&SWING, &LONG_SWING),
            (&VOYAGE, &VOYAGE),
            (&EVERY_SECOND, &EVERY_SECOND),
        ] {
            for digit in [0.0, 0.1, 1.0] {
                let own = instruments(digit);
                let with_variation = pairs(seed, passage, &own, |m| m.shown_deg + m.variation_deg);
                assert_refused("variation added", &with_variation);
                // In whole degrees only the change of the variation shows it.
                if digit < 1.0 || passage.seconds > 1.0 {
                    let rounded_again = pairs(seed, longer, &own, |m| {
                        rounded(m.shown_deg + m.variation_deg, digit)
                    });
                    assert_refused("rounded again", &rounded_again);
                }
                if digit < 1.0 {
                    let set_by_hand = pairs(seed, passage, &own, |m| m.shown_deg - 2.0);
                    assert_refused("one variation for all", &set_by_hand);
                }
            }
            let tenths = instruments(0.1);
            let each = pairs(seed, passage, &tenths, |m| {
                rounded(m.raw_deg + m.variation_deg, 0.1)
            });
            assert_refused("each rounded", &each);
            let card = pairs(seed, passage, &tenths, |m| {
                let deviation = 3.0 * (m.shown_deg.to_radians().sin());
                rounded(m.shown_deg + deviation + m.variation_deg, 0.1)
            });
            assert_refused("corrected by a card", &card);
        }
    }
}

/// Returns the compass as it was shown so many rows ago on this course.
fn late(m: &Moment<'_>, rows: usize) -> f64 {
    m.shown[m.shown.len() - (1 + rows).min(m.on_course)]
}

/// Returns the mean of so many last readings on this course.
fn smoothed(m: &Moment<'_>, rows: usize) -> f64 {
    let last = &m.shown[m.shown.len() - rows.min(m.on_course)..];
    last.iter().sum::<f64>() / last.len() as f64
}

#[test]
fn a_copy_with_noise_of_its_own_is_refused_by_the_means_of_courses() {
    for seed in 0..20 {
        for digit in [0.0, 0.1] {
            for noise_deg in [0.05, 0.1] {
                let noisy = pairs(seed, &PASSAGE, &instruments(digit), |m| {
                    rounded(
                        m.shown_deg + m.variation_deg + noise_deg * gauss(m.rng),
                        digit,
                    )
                });
                assert_refused("noise added", &noisy);
            }
        }
    }
}

#[test]
fn a_copy_that_is_late_or_smoothed_is_refused_by_the_means_of_courses() {
    for seed in 0..4 {
        for digit in [0.1, 1.0] {
            let own = instruments(digit);
            for rows in [2, 5] {
                let lagging = pairs(seed, &LONG_COURSES, &own, |m| {
                    late(m, rows) + m.variation_deg
                });
                assert_refused("late", &lagging);
            }
            let calm = pairs(seed, &LONG_COURSES, &own, |m| {
                smoothed(m, 11) + m.variation_deg
            });
            assert_refused("smoothed", &calm);
        }
    }
}

#[test]
fn a_well_adjusted_compass_on_a_long_passage_passes() {
    for seed in 0..20 {
        for digit in [0.0, 0.1, 1.0] {
            let adjusted = pairs(seed, &PASSAGE, &instruments(digit), |m| {
                rounded(m.true_deg + 0.15 * gauss(m.rng), digit)
            });
            let checked = check_independence(&adjusted);
            assert!(checked.is_ok(), "{seed} {digit}: {checked:?}");
        }
    }
}

/// Swing on set headings: both instruments show the same whole degrees, and nothing between.
#[test]
fn a_swing_on_set_headings_in_whole_degrees_passes() {
    let own = instruments(1.0);
    let mut swing = pairs(3, &PASSAGE, &own, |m| m.true_deg);
    for (row, pair) in swing.iter_mut().enumerate() {
        let heading_deg = 5.0 * (row / 12) as f64;
        pair.compass = CompassHeading::new(heading_deg).unwrap();
        pair.reference = TrueHeading::new(heading_deg).unwrap();
        pair.variation = Variation::new(0.0).unwrap();
    }
    let thirty: Vec<HeadingPair> = swing.into_iter().step_by(12).take(36).collect();
    assert_eq!(check_independence(&thirty), Ok(()));
}

#[test]
fn a_copy_that_lags_by_a_second_is_refused() {
    for seed in 0..20 {
        for digit in [0.1, 1.0] {
            let lagging = pairs(seed, &EVERY_SECOND, &instruments(digit), |m| {
                m.shown[m.shown.len().saturating_sub(2)] + m.variation_deg
            });
            assert_refused("lagging", &lagging);
        }
    }
}

#[test]
fn few_pairs_or_few_headings_are_not_refused() {
    let own = instruments(0.1);
    let few = Passage {
        courses: 10,
        ..SWING
    };
    let copy = |m: &mut Moment<'_>| m.shown_deg + m.variation_deg;
    assert!(check_independence(&pairs(1, &few, &own, copy)).is_ok());
    // One course, on which both show the same digits.
    let steady = Passage {
        courses: 1,
        rows_each: 500,
        yaw_deg: 0.0,
        ..SWING
    };
    let still = Instruments {
        compass_noise_deg: 0.0,
        ..instruments(1.0)
    };
    let one = pairs(1, &steady, &still, |m| rounded(m.true_deg, 1.0));
    assert!(check_independence(&one).is_ok());
}

#[test]
fn a_gyro_beside_a_restless_compass_on_a_steady_course_is_independent() {
    for seed in 0..20 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let start = Timestamp::parse("2026-03-01T00:00:00Z").unwrap();
        let course = 360.0 * rng.random::<f64>();
        for kept in [0.0, 0.5, 0.9] {
            let mut noise_deg = 0.0;
            // The true heading does not move at all, so that any noise lies on a line.
            let pairs: Vec<HeadingPair> = (0..80)
                .map(|row| {
                    noise_deg = kept * noise_deg + 0.12 * gauss(&mut rng);
                    HeadingPair {
                        time: Some(start.plus_seconds(10.0 * f64::from(row))),
                        position: Some(Position::new(20.0, -30.0).unwrap()),
                        compass: CompassHeading::new(course - 3.0 + noise_deg).unwrap(),
                        reference: TrueHeading::new(course).unwrap(),
                        variation: Variation::new(2.0).unwrap(),
                        sog_kn: None,
                    }
                })
                .collect();
            let evidence = weigh_independence(&pairs).unwrap();
            assert!(evidence.favours_independence(), "{seed}: {evidence:?}");
        }
    }
}
