//! Invalid data: a named refusal or an honest wide band, never a NaN and never a panic.

#![allow(clippy::unwrap_used)] // all of this is tests

#[allow(dead_code, reason = "other tests use the rest")]
mod voyages;

use binnacle_analysis::fit::{
    HeadingReading, Observation, RobustFit, RobustOptions, fit_robust, observe_readings,
};
use binnacle_compass::angle::{CompassHeading, Deviation, TrueHeading, Variation, wrap_180};
use binnacle_compass::model::Caution;
use binnacle_compass::position::Position;
use binnacle_compass::result::FitError;
use binnacle_compass::time::Timestamp;
use voyages::{Faults, Truth, Variety, Voyage, predicted, sail, true_deviation};

fn fit(observations: &[Observation]) -> Result<RobustFit, FitError> {
    let fit = fit_robust(observations, &RobustOptions::default())?;
    let covariance = fit.model.covariance.unwrap();
    let numbers = fit.model.parameters_over_lambda.to_array();
    assert!(
        numbers
            .iter()
            .chain(covariance.as_flattened())
            .all(|x| x.is_finite())
    );
    Ok(fit)
}

fn cautions(fit: &RobustFit) -> &[Caution] {
    &fit.model.quality.as_ref().unwrap().cautions
}

/// Returns the share of headings on which the band at the ship's place holds the truth.
fn held(voyage: &Voyage, fit: &RobustFit) -> f64 {
    let Truth { h_nt, z_nt, .. } = voyage.truth;
    let held = (0..36).filter(|k| {
        let compass = f64::from(*k) * 10.0;
        let truth = true_deviation(&voyage.truth, compass, h_nt, z_nt);
        let (deviation, se) = predicted(&fit.model, compass, h_nt, z_nt);
        wrap_180(deviation - truth).abs() <= 1.96 * se
    });
    held.count() as f64 / 36.0
}

fn band(voyage: &Voyage, fit: &RobustFit) -> f64 {
    let Truth { h_nt, z_nt, .. } = voyage.truth;
    1.96 * predicted(&fit.model, 90.0, h_nt, z_nt).1
}

fn voyage(days: f64) -> Voyage {
    sail(8000, Variety::Medium, days, &Faults::USUAL)
}

#[test]
fn one_heading_all_the_way_is_refused_for_want_of_headings() {
    let mut observations = voyage(20.0).observations;
    for observation in &mut observations {
        observation.compass = CompassHeading::new(73.0).unwrap();
    }
    let refused = fit(&observations).unwrap_err();
    assert!(
        matches!(refused, FitError::TooFewHeadings { found: 1, .. }),
        "{refused}"
    );
}

#[test]
fn two_samples_are_refused_for_want_of_samples() {
    let observations = voyage(20.0).observations;
    let refused = fit(&observations[..2]).unwrap_err();
    assert!(
        matches!(refused, FitError::TooFewSamples { found: 2, .. }),
        "{refused}"
    );
}

/// A clock that stood still: a hundred rows of one time.
#[test]
fn rows_of_one_time_do_not_disturb_the_fit() {
    let voyage = voyage(30.0);
    let mut observations = voyage.observations.clone();
    let stopped = observations[500].time;
    for observation in &mut observations[500..600] {
        observation.time = stopped;
    }
    assert!(held(&voyage, &fit(&observations).unwrap()) > 0.9);
}

/// Rows of one time or of two seem identical, or new each: their times are not plausible.
#[test]
fn rows_that_share_their_times_are_taken_for_rows_without() {
    let voyage = voyage(30.0);
    let mut untimed = voyage.observations.clone();
    for observation in &mut untimed {
        observation.time = None;
    }
    let untimed = fit(&untimed).unwrap();
    for times in [1, 2] {
        let mut observations = voyage.observations.clone();
        for (row, observation) in observations.iter_mut().enumerate() {
            observation.time = voyage.observations[row % times].time;
        }
        let at_once = fit(&observations).unwrap();
        assert_eq!(at_once, untimed);
        assert!(cautions(&at_once).contains(&Caution::NoTimes));
    }
}

#[test]
fn ten_years_without_a_sample_make_the_band_no_bolder() {
    let voyage = voyage(40.0);
    let mut observations = voyage.observations.clone();
    let half = observations.len() / 2;
    for observation in &mut observations[..half] {
        let before = observation.time.unwrap().micros() - 10 * 31_557_600_000_000;
        observation.time = Some(Timestamp::from_micros(before).unwrap());
    }
    let together = fit(&voyage.observations).unwrap();
    let apart = fit(&observations).unwrap();
    assert!(held(&voyage, &apart) > 0.9);
    let bx_variance = |fit: &RobustFit| fit.model.covariance.unwrap()[0][0];
    // A vessel unchanged after ten years drifts little, but no gap can show more than no
    // gap.
    assert!(bx_variance(&apart) > 0.9 * bx_variance(&together));
}

/// The variation is 180° larger: every reference heading passes through south where it
/// passed through north.
#[test]
fn variations_about_180_degrees_change_nothing() {
    let voyage = voyage(20.0);
    let readings = |turned: f64| -> Vec<HeadingReading> {
        let of = |o: &Observation| {
            let heading = o.compass.degrees()
                + o.deviation.degrees_east()
                + o.variation.degrees_east()
                + turned;
            HeadingReading {
                time: o.time,
                position: Some(Position::new(0.0, -30.0).unwrap()),
                compass: o.compass,
                gyro: TrueHeading::new(heading),
                satellite: TrueHeading::new(heading + 0.1),
                unnamed: None,
                variation: Variation::new(o.variation.degrees_east() + turned).unwrap(),
                h_nt: o.h_nt,
                z_nt: o.z_nt,
                sog_kn: None,
                windows: 60,
                spread_deg: None,
                weight: 1.0,
            }
        };
        voyage.observations.iter().map(of).collect()
    };
    let model = |turned: f64| {
        let referred = observe_readings(&readings(turned), 0.5).unwrap();
        let observations: Vec<Observation> = referred.observations.into_iter().flatten().collect();
        fit(&observations).unwrap().model
    };
    let (there, turned) = (model(0.0), model(180.0));
    for heading in 0..36 {
        let compass = f64::from(heading) * 10.0;
        let Truth { h_nt, z_nt, .. } = voyage.truth;
        let (a, b) = (
            predicted(&there, compass, h_nt, z_nt).0,
            predicted(&turned, compass, h_nt, z_nt).0,
        );
        assert!((a - b).abs() < 1e-3, "{compass}: {a} {b}");
    }
}

#[test]
fn a_reference_that_never_moves_is_refused_by_name() {
    let voyage = voyage(20.0);
    let readings: Vec<HeadingReading> = voyage
        .observations
        .iter()
        .map(|o| HeadingReading {
            time: o.time,
            position: o.position,
            compass: o.compass,
            gyro: TrueHeading::new(123.4),
            satellite: None,
            unnamed: None,
            variation: o.variation,
            h_nt: o.h_nt,
            z_nt: o.z_nt,
            sog_kn: o.sog_kn,
            windows: o.windows,
            spread_deg: o.spread_deg,
            weight: 1.0,
        })
        .collect();
    let refused = observe_readings(&readings, 0.5).unwrap_err();
    assert!(
        matches!(refused, FitError::ReferenceStuck { .. }),
        "{refused}"
    );
    // Without the check the fit finds no such ship.
    let observations: Vec<Observation> = voyage
        .observations
        .iter()
        .map(|o| Observation {
            deviation: Deviation::new(123.4 - o.variation.degrees_east() - o.compass.degrees())
                .unwrap(),
            ..*o
        })
        .collect();
    if let Ok(fit) = fit(&observations) {
        assert!(band(&voyage, &fit) > 3.0, "an honest band is wide");
    }
}

/// A gyro alone has small and large errors for a week out of six.
#[test]
fn a_gyro_that_is_wrong_for_a_week_does_not_break_the_band() {
    for wrong_deg in [2.0, 5.0, 15.0, 60.0] {
        let voyage = voyage(42.0);
        let mut observations = voyage.observations.clone();
        let begin = voyage.start.plus_seconds(14.0 * 86_400.0);
        for observation in &mut observations {
            let days = observation.time.unwrap().seconds_since(begin) / 86_400.0;
            if (0.0..7.0).contains(&days) {
                let deviation = observation.deviation.degrees_east() + wrong_deg;
                observation.deviation = Deviation::new(deviation).unwrap();
            }
        }
        match fit(&observations) {
            Ok(fit) => assert!(held(&voyage, &fit) > 0.9, "{wrong_deg}"),
            Err(refused) => panic!("{wrong_deg}: {refused}"),
        }
    }
}

#[test]
fn a_field_too_weak_for_a_compass_is_named() {
    let mut observations = voyage(20.0).observations;
    for observation in &mut observations {
        observation.h_nt = 1500.0;
    }
    let refused = fit(&observations).unwrap_err();
    assert!(
        matches!(refused, FitError::FieldTooWeak { .. }),
        "{refused}"
    );
}

/// Reference less compass holds the variation; with its sign changed it holds it twice.
#[test]
fn a_variation_of_the_wrong_sign_is_refused_by_name() {
    for seed in 8100..8104 {
        let mut observations = sail(seed, Variety::Rich, 30.0, &Faults::USUAL).observations;
        let variation = |o: &Observation| 8.0 * o.variation.degrees_east();
        let spread = observations.iter().map(variation).fold(0.0, f64::max)
            - observations.iter().map(variation).fold(0.0, f64::min);
        assert!(spread > 20.0, "the dipole's variation says too little");
        for o in &mut observations {
            let wrong = o.deviation.degrees_east() + variation(o);
            o.deviation = Deviation::new(wrong).unwrap();
        }
        let refused = fit(&observations).unwrap_err();
        assert!(
            matches!(refused, FitError::Contradictory { residual_deg, .. } if residual_deg > 3.0),
            "{refused}"
        );
    }
}

#[test]
fn compass_and_gyro_that_changed_places_are_refused_by_name() {
    let mut observations = sail(8110, Variety::Rich, 30.0, &Faults::USUAL).observations;
    for o in &mut observations {
        let variation = 4.0 * o.variation.degrees_east();
        let gyro = o.compass.degrees() + o.deviation.degrees_east() + variation;
        let (compass, reference) = (gyro, o.compass.degrees());
        o.compass = CompassHeading::new(compass).unwrap();
        o.deviation = Deviation::new(reference - variation - compass).unwrap();
    }
    match fit(&observations) {
        Err(refused) => assert!(
            matches!(refused, FitError::Contradictory { .. }),
            "{refused}"
        ),
        Ok(fit) => assert!(
            cautions(&fit)
                .iter()
                .any(|c| matches!(c, Caution::LargeResiduals { .. })),
            "{:?}",
            cautions(&fit)
        ),
    }
}

/// Three times the usual swing of gyro and compass, and one reading in ten 20° off.
#[test]
fn bad_weather_with_wild_readings_is_not_refused() {
    let bad = Faults {
        schuler_deg: 1.0,
        swing_deg: 0.6,
        variation_deg: 0.4,
        ..Faults::USUAL
    };
    for seed in 8120..8124 {
        let mut observations = sail(seed, Variety::Medium, 20.0, &bad).observations;
        for o in observations.iter_mut().step_by(10) {
            o.deviation = Deviation::new(o.deviation.degrees_east() + 20.0).unwrap();
        }
        assert!(fit(&observations).is_ok(), "{seed}");
    }
}

#[test]
fn sound_instruments_give_no_caution_about_residuals() {
    for seed in 8130..8136 {
        let fit = fit(&sail(seed, Variety::Rich, 20.0, &Faults::USUAL).observations).unwrap();
        let about_residuals = |c: &Caution| matches!(c, Caution::LargeResiduals { .. });
        assert!(!cautions(&fit).iter().any(about_residuals), "{seed}");
    }
}

/// Error without the reference's own constant, which would hide a band too narrow.
#[test]
fn without_times_the_band_still_holds() {
    let (mut held, mut looked_at) = (0, 0);
    for seed in 8200..8224 {
        let variety = [Variety::Rich, Variety::Medium, Variety::Poor][seed as usize % 3];
        let voyage = sail(seed, variety, 20.0, &Faults::USUAL);
        let mut untimed = voyage.observations.clone();
        for o in &mut untimed {
            (o.time, o.position) = (None, None);
        }
        let fit = fit(&untimed).unwrap();
        assert!(cautions(&fit).contains(&Caution::NoTimes));
        let Truth { h_nt, z_nt, .. } = voyage.truth;
        for k in 0..36 {
            let compass = f64::from(k) * 10.0;
            let truth =
                true_deviation(&voyage.truth, compass, h_nt, z_nt) + voyage.truth.gyro_constant_deg;
            let (deviation, se) = predicted(&fit.model, compass, h_nt, z_nt);
            let shape_se = (se * se - 0.25).max(0.0).sqrt();
            held += u32::from(wrap_180(deviation - truth).abs() <= 1.96 * shape_se);
            looked_at += 1;
        }
    }
    let share = f64::from(held) / f64::from(looked_at);
    assert!(share >= 0.93, "{share}");
}

/// One row out of a month has the date of a clock that was never set.
#[test]
fn a_row_with_a_date_of_years_ago_is_left_out() {
    for seed in 8300..8303 {
        let voyage = sail(seed, Variety::Rich, 30.0, &Faults::USUAL);
        let right = fit(&voyage.observations).unwrap();
        for date in [
            "1970-01-01T00:00:00Z",
            "2006-05-01T00:00:00Z",
            "2015-01-01T00:00:00Z",
        ] {
            let mut observations = voyage.observations.clone();
            let at = observations.len() / 3;
            observations[at].time = Some(Timestamp::parse(date).unwrap());
            let wrong = fit(&observations).unwrap();
            assert!(wrong.rows[at].weight < 0.5, "{date}");
            assert!((band(&voyage, &wrong) / band(&voyage, &right) - 1.0).abs() < 0.1);
        }
    }
}

#[test]
fn a_row_years_after_the_others_widens_the_band_and_says_so() {
    let voyage = sail(8310, Variety::Rich, 30.0, &Faults::USUAL);
    let mut observations = voyage.observations.clone();
    let at = observations.len() / 3;
    let later = Timestamp::parse("2029-05-01T00:00:00Z").unwrap();
    observations[at].time = Some(later);
    let fit = fit(&observations).unwrap();
    let said = cautions(&fit).iter().find_map(|caution| match caution {
        Caution::LongGap { days, last } => Some((*days, *last)),
        _ => None,
    });
    let (days, last) = said.unwrap();
    assert_eq!(last, later);
    assert!((900.0..1000.0).contains(&days), "{days}");
}

#[test]
fn the_headings_that_are_missing_are_named() {
    let mut observations = voyage(20.0).observations;
    observations.retain(|o| o.compass.degrees() < 90.0);
    let refused = fit(&observations).unwrap_err();
    assert!(
        refused.to_string().contains("missing: 090-360"),
        "{refused}"
    );
    for observation in &mut observations {
        observation.weight = 0.0;
    }
    let refused = fit(&observations).unwrap_err();
    assert!(matches!(refused, FitError::NoWeight { .. }), "{refused}");
}

/// Three ships by turns, or cargo that turns the compass by half a right angle in half of the
/// time: no model with a caution beside it.
#[test]
fn samples_that_no_one_ship_explains_are_refused_by_name() {
    for seed in 8400..8403 {
        let sound = sail(seed, Variety::Medium, 30.0, &Faults::USUAL).observations;
        let half = sound.len() / 2;
        let three_ships = |row: usize, _: f64| [0.0, 40.0, -50.0][row % 3];
        let cargo = |row: usize, sin: f64| if row < half { 35.0 * sin } else { 0.0 };
        let offsets: [&dyn Fn(usize, f64) -> f64; 2] = [&three_ships, &cargo];
        for off in offsets {
            let mut observations = sound.clone();
            for (row, o) in observations.iter_mut().enumerate() {
                let off = off(row, o.compass.radians().sin());
                o.deviation = Deviation::new(o.deviation.degrees_east() + off).unwrap();
            }
            let refused = fit(&observations).map(|fit| fit.model.rms_deg).unwrap_err();
            assert!(
                matches!(
                    refused,
                    FitError::Contradictory { .. }
                        | FitError::FewSamplesUsed { .. }
                        | FitError::ModelDoesNotExplain { .. }
                ),
                "{seed}: {refused}"
            );
        }
    }
}
