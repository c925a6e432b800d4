//! The whole analysis: independent of the order of samples, and always with a result.

#![allow(clippy::unwrap_used)] // all of this is tests

mod logbook;
mod references;

use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading};
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::logbook::{Cargo, LogbookEntry, LogbookKind};
use binnacle_compass::model::Parameters;
use binnacle_compass::position::Position;
use binnacle_compass::result::{Analysis, FitError, SampleReason};
use binnacle_compass::sample::{Sample, SourceId};
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;

const SHIP: Parameters = Parameters {
    bx_nt: 1800.0,
    chi13: -0.01,
    by_nt: -1200.0,
    chi23: 0.004,
    chi11_minus_chi22: 0.03,
    chi12: 0.002,
    chi21: 0.002,
};

fn time(minutes: i64) -> Timestamp {
    Timestamp::parse("2026-03-01T00:00:00Z")
        .unwrap()
        .plus_seconds(minutes as f64 * 60.0)
}

/// Error of the gyro at a time, degrees: even within ±0.2° and without memory. Without one,
/// the reference would be the compass's own heading.
fn gyro_error_deg(minutes: i64) -> f64 {
    let turns = minutes as f64 * 0.618_033_988_75;
    0.4 * (turns - turns.floor()) - 0.2
}

/// A sample of a perfect compass of `SHIP` with a gyro.
fn sample(minutes: i64, lat: f64, magnetic_deg: f64) -> Sample {
    let position = Position::new(lat, -15.0).unwrap();
    let earth = field(FieldModel::Igrf14, position, 0.0, time(minutes)).unwrap();
    let needle = SHIP.linearised_at_magnetic(magnetic_deg.to_radians(), earth.for_ship());
    let compass = magnetic_deg - needle.deviation_rad.to_degrees();
    let compass = CompassHeading::new(compass).unwrap();
    let gyro_deg = magnetic_deg + earth.declination().degrees_east() + gyro_error_deg(minutes);
    Sample {
        gyro: TrueHeading::new(gyro_deg),
        sog_kn: Some(14.0),
        rate_of_turn_deg_min: Some(0.0),
        spread_deg: Some(0.3),
        windows: 60,
        ..Sample::new(time(minutes), position, compass)
    }
}

/// Ten-minute samples on ever-changing headings, from 50° N to 30° S.
fn voyage() -> Vec<Sample> {
    (0..1000_i32)
        .map(|i| {
            let lat = 50.0 - 0.08 * f64::from(i);
            sample(i64::from(i) * 10, lat, f64::from(i / 5 * 47 % 360))
        })
        .collect()
}

fn analyse_with(
    samples: &[Sample],
    logbook: &[LogbookEntry],
    settings: &AnalysisSettings,
) -> Analysis {
    binnacle_tracking::analyse(&binnacle_tracking::Input {
        samples,
        logbook,
        azimuths: &[],
        prior: &ShipPrior::population(),
        settings: *settings,
    })
}

fn run(samples: &[Sample]) -> Analysis {
    analyse_with(samples, &[], &AnalysisSettings::default())
}

#[test]
fn order_and_repetition_leave_no_trace() {
    let samples = voyage();
    let expected = serde_json::to_string(&run(&samples)).unwrap();
    let mut shuffled: Vec<Sample> = samples.iter().rev().copied().collect();
    shuffled.rotate_left(333);
    shuffled.extend_from_slice(&samples[100..400]);
    assert_eq!(serde_json::to_string(&run(&shuffled)).unwrap(), expected);
}

#[test]
fn samples_that_differ_beside_the_headings_alone_have_an_order() {
    let samples = voyage();
    let changes: [fn(&mut Sample); 6] = [
        |s| s.cog = CourseOverGround::new(91.0),
        |s| s.roll_deg = Some(1.0),
        |s| s.roll_spread_deg = Some(1.0),
        |s| s.temperature_c = Some(1.0),
        |s| s.gyro_source = Some(SourceId::new(1)),
        |s| s.satellite_source = Some(SourceId::new(1)),
    ];
    let twins = changes.map(|change| {
        let mut twin = samples[100];
        change(&mut twin);
        twin
    });
    let before = [&twins[..], &samples].concat();
    let mut backwards = twins;
    backwards.reverse();
    let after = [&samples, &backwards[..]].concat();
    let found = run(&before);
    assert_eq!(found.samples.len(), samples.len() + twins.len());
    let text = |analysis: &Analysis| serde_json::to_string(analysis).unwrap();
    assert_eq!(text(&found), text(&run(&after)));
}

#[test]
fn a_perfect_voyage_gives_the_ship_back() {
    let analysis = run(&voyage());
    let epoch = analysis.current_epoch().unwrap();
    let model = epoch.model.as_ref().unwrap();
    let found = model.parameters_over_lambda.to_array();
    // One reference alone hardly tells its constant from χ12 and χ21.
    let within = [20.0, 6e-4, 20.0, 6e-4, 4e-4, 1e-3, 1e-3];
    for ((found, truth), within) in found.iter().zip(SHIP.to_array()).zip(within) {
        assert!((found - truth).abs() < within, "{found} for {truth}");
    }
    assert!(model.constant_deg.abs() < 0.05);
    assert_eq!((model.samples_used, model.samples_rejected), (1000, 0));
    let reported = model.identifiable.unwrap();
    assert!(
        reported.bx_nt
            && reported.chi13
            && reported.by_nt
            && reported.chi23
            && reported.chi11_minus_chi22
    );
    assert!(!reported.constant_deg);
    assert_eq!(
        analysis
            .coverage
            .cells
            .iter()
            .map(|c| c.samples)
            .sum::<u64>(),
        1000
    );
    assert!(analysis.last_place.unwrap().position.lat_deg() < -29.0);
}

#[test]
fn an_analysis_comes_back_from_json_as_it_went() {
    let analysis = run(&voyage()[..60]);
    let json = serde_json::to_string(&analysis).unwrap();
    let back: Analysis = serde_json::from_str(&json).unwrap();
    // Numbers may lose their last bit in serde_json; nothing else may change.
    assert_eq!(back.samples.len(), 60);
    assert_eq!(back.epochs[0].refusal, analysis.epochs[0].refusal);
    assert_eq!(
        back.epochs[0].model.is_some(),
        analysis.epochs[0].model.is_some()
    );
    assert_eq!(back.coverage, analysis.coverage);
    assert_eq!(back.data_until, analysis.data_until);
}

#[test]
fn nothing_at_all_is_refused_and_not_an_error() {
    let analysis = run(&[]);
    assert_eq!(
        analysis.epochs[0].refusal,
        Some(FitError::TooFewSamples {
            found: 0,
            needed: 12
        })
    );
    assert_eq!(analysis.last_place, None);
}

#[test]
fn what_cannot_carry_a_model_is_refused_by_name() {
    let one_heading: Vec<Sample> = (0..50).map(|i| sample(i * 10, 40.0, 90.0)).collect();
    assert!(matches!(
        run(&one_heading).epochs[0].refusal,
        Some(FitError::TooFewHeadings { found: 1, .. })
    ));
    let two = &voyage()[..2];
    assert!(matches!(
        run(two).epochs[0].refusal,
        Some(FitError::TooFewSamples { found: 2, .. })
    ));
}

#[test]
fn no_input_makes_it_panic_or_say_nan() {
    let base = voyage();
    let same_time: Vec<Sample> = base
        .iter()
        .map(|s| Sample {
            time: time(0),
            ..*s
        })
        .collect();
    let years_apart: Vec<Sample> = base[..40]
        .iter()
        .enumerate()
        .map(|(i, s)| Sample {
            time: time(5_256_000 * i64::try_from(i).unwrap() - 400_000_000),
            ..*s
        })
        .collect();
    let fixed_gyro: Vec<Sample> = base
        .iter()
        .map(|s| Sample {
            gyro: TrueHeading::new(123.0),
            ..*s
        })
        .collect();
    let upside_down: Vec<Sample> = base
        .iter()
        .map(|s| Sample {
            gyro: TrueHeading::new(-s.compass.degrees()),
            ..*s
        })
        .collect();
    let at_the_pole: Vec<Sample> = base
        .iter()
        .map(|s| Sample {
            position: Position::new(86.0, 143.0).unwrap(),
            ..*s
        })
        .collect();
    for samples in [same_time, years_apart, fixed_gyro, upside_down, at_the_pole] {
        let analysis = run(&samples);
        let epoch = &analysis.epochs[0];
        assert!(epoch.model.is_some() != epoch.refusal.is_some());
        if let Some(model) = &epoch.model {
            let numbers = model.parameters_over_lambda.to_array();
            assert!(numbers.iter().all(|x| x.is_finite()));
            let covariance = model.covariance.unwrap();
            assert!(covariance.iter().flatten().all(|x| x.is_finite()));
            assert!((0..8).all(|j| covariance[j][j] > 0.0));
        }
    }
}

#[test]
fn a_very_magnetic_ship_is_fitted_all_the_same() {
    // Some twenty-five degrees of deviation at home, more in the south.
    let ship = Parameters {
        bx_nt: 6500.0,
        by_nt: -5500.0,
        chi13: -0.05,
        ..SHIP
    };
    let samples: Vec<Sample> = (0..1000_i32)
        .map(|i| {
            let minutes = 10 * i64::from(i);
            let position = Position::new(50.0 - 0.05 * f64::from(i), -15.0).unwrap();
            let earth = field(FieldModel::Igrf14, position, 0.0, time(minutes)).unwrap();
            let magnetic = f64::from(i / 5 * 47 % 360);
            let needle = ship.linearised_at_magnetic(magnetic.to_radians(), earth.for_ship());
            Sample {
                time: time(minutes),
                position,
                compass: CompassHeading::new(magnetic - needle.deviation_rad.to_degrees()).unwrap(),
                gyro: TrueHeading::new(magnetic + earth.declination().degrees_east()),
                ..sample(minutes, 0.0, 0.0)
            }
        })
        .collect();
    let analysis = run(&samples);
    let model = analysis.epochs[0].model.as_ref().unwrap();
    assert!(
        (model.parameters_over_lambda.bx_nt - 6500.0).abs() < 60.0,
        "{model:?}"
    );
    assert!(model.rms_deg.unwrap() < 0.1, "{:?}", model.rms_deg);
}
