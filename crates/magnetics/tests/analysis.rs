//! The whole analysis: the same whatever the order, and never at a loss.

#![allow(clippy::unwrap_used)] // all of this is tests

use binnacle_magnetics::analyse::{
    Analysis, AnalysisSettings, Cargo, LogbookEntry, LogbookKind, SampleReason, analyse,
};
use binnacle_magnetics::angle::{CompassHeading, TrueHeading};
use binnacle_magnetics::field::{FieldModel, field};
use binnacle_magnetics::fit::FitError;
use binnacle_magnetics::model::Parameters;
use binnacle_magnetics::position::Position;
use binnacle_magnetics::sample::Sample;
use binnacle_magnetics::time::Timestamp;

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

/// A sample of a perfect compass of `SHIP` with a perfect gyro.
fn sample(minutes: i64, lat: f64, magnetic_deg: f64) -> Sample {
    let position = Position::new(lat, -15.0).unwrap();
    let earth = field(FieldModel::Igrf14, position, 0.0, time(minutes)).unwrap();
    let needle = SHIP.linearised_at_magnetic(magnetic_deg.to_radians(), earth.for_ship());
    let compass = magnetic_deg - needle.deviation_rad.to_degrees();
    Sample {
        time: time(minutes),
        position,
        compass: CompassHeading::new(compass).unwrap(),
        gyro: TrueHeading::new(magnetic_deg + earth.declination().degrees_east()),
        satellite: None,
        sog_kn: Some(14.0),
        rate_of_turn_deg_min: Some(0.0),
        spread_deg: Some(0.3),
        windows: 60,
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

fn run(samples: &[Sample]) -> Analysis {
    analyse(samples, &[], &AnalysisSettings::default())
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
fn a_perfect_voyage_gives_the_ship_back() {
    let analysis = run(&voyage());
    let epoch = analysis.current_epoch().unwrap();
    let model = epoch.model.as_ref().unwrap();
    let found = model.parameters_over_lambda.to_array();
    let within = [20.0, 6e-4, 20.0, 6e-4, 4e-4, 4e-4, 4e-4];
    for ((found, truth), within) in found.iter().zip(SHIP.to_array()).zip(within) {
        assert!((found - truth).abs() < within, "{found} for {truth}");
    }
    assert!(model.constant_deg.abs() < 0.05);
    assert_eq!((model.samples_used, model.samples_rejected), (1000, 0));
    let told = model.identifiable.unwrap();
    assert!(told.bx_nt && told.chi13 && told.by_nt && told.chi23 && told.chi11_minus_chi22);
    assert!(!told.constant_deg);
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
fn an_adjustment_begins_an_epoch_and_cargo_is_left_out() {
    let logbook = [
        LogbookEntry {
            from: time(5000),
            to: None,
            kind: LogbookKind::Adjustment,
            cargo: None,
            note: "new magnets".into(),
        },
        LogbookEntry {
            from: time(100),
            to: Some(time(995)),
            kind: LogbookKind::MagneticCargo,
            cargo: None,
            note: String::new(),
        },
        LogbookEntry {
            from: time(300),
            to: None,
            kind: LogbookKind::Note,
            cargo: None,
            note: String::new(),
        },
    ];
    let analysis = analyse(&voyage(), &logbook, &AnalysisSettings::default());
    assert_eq!(analysis.epochs.len(), 2);
    assert_eq!(analysis.epochs[0].to, Some(time(5000)));
    assert_eq!(analysis.epochs[1].from, Some(time(5000)));
    assert_eq!(analysis.epochs[1].data_from, Some(time(5000)));
    assert_eq!(analysis.epochs[1].begun_by, Some(LogbookKind::Adjustment));
    let left_out = analysis
        .samples
        .iter()
        .filter(|s| s.reason == Some(SampleReason::MagneticCargo))
        .count();
    assert_eq!(left_out, 90);
    assert!(
        analysis
            .samples
            .iter()
            .all(|s| s.used == s.reason.is_none())
    );
}

/// An entry over a stretch of the voyage, in minutes.
fn entry(kind: LogbookKind, from: i64, to: Option<i64>) -> LogbookEntry {
    LogbookEntry {
        from: time(from),
        to: to.map(time),
        kind,
        cargo: None,
        note: String::new(),
    }
}

fn left_out_for(logbook: &[LogbookEntry], reason: SampleReason) -> usize {
    let analysis = analyse(&voyage(), logbook, &AnalysisSettings::default());
    let samples = analysis.samples.iter();
    samples.filter(|s| s.reason == Some(reason)).count()
}

#[test]
fn cargo_and_berth_leave_out_the_samples_of_their_time_once_however_they_overlap() {
    let logbook = [
        entry(LogbookKind::MagneticCargo, 3000, Some(3990)),
        entry(LogbookKind::MagneticCargo, 3500, Some(4490)),
        entry(LogbookKind::Berth, 2500, Some(3490)),
        entry(LogbookKind::Berth, -600, Some(-10)),
    ];
    let mut reversed = logbook.to_vec();
    reversed.reverse();
    for logbook in [&logbook[..], &reversed] {
        assert_eq!(left_out_for(logbook, SampleReason::MagneticCargo), 150);
        assert_eq!(left_out_for(logbook, SampleReason::Berth), 50);
    }
}

#[test]
fn cargo_goes_on_until_it_is_discharged_but_a_berth_only_until_she_sails() {
    let open = [entry(LogbookKind::MagneticCargo, 9000, None)];
    assert_eq!(left_out_for(&open, SampleReason::MagneticCargo), 100);
    let open = [entry(LogbookKind::Berth, 9000, None)];
    assert_eq!(left_out_for(&open, SampleReason::Berth), 0, "at 14 knots");
    let mut samples = voyage();
    for (sample, sog_kn) in samples[990..].iter_mut().zip([None, Some(0.3)]) {
        sample.sog_kn = sog_kn;
    }
    let analysis = analyse(&samples, &open, &AnalysisSettings::default());
    let reasons: Vec<_> = analysis.samples[989..993]
        .iter()
        .map(|s| s.reason)
        .collect();
    let berth = Some(SampleReason::Berth);
    assert_eq!(reasons, [None, berth, berth, None]);
}

#[test]
fn work_on_ship_or_compass_opens_an_epoch_and_a_blow_does_not() {
    use LogbookKind as K;
    let opens = |kind| {
        let logbook = [entry(kind, 5000, None)];
        analyse(&voyage()[400..600], &logbook, &AnalysisSettings::default())
            .epochs
            .len()
            == 2
    };
    for kind in [
        K::Adjustment,
        K::CorrectorChange,
        K::CompassMoved,
        K::Repair,
        K::DryDocking,
        K::Welding,
        K::Degaussing,
    ] {
        assert!(opens(kind), "{kind:?}");
    }
    for kind in [K::Lightning, K::Shock, K::MagneticCargo, K::Berth, K::Note] {
        assert!(!opens(kind), "{kind:?}");
    }
}

#[test]
fn an_adjustment_before_the_first_sample_costs_none() {
    let logbook = [entry(LogbookKind::Adjustment, -1000, None)];
    let analysis = analyse(&voyage(), &logbook, &AnalysisSettings::default());
    let model = analysis.current_epoch().unwrap().model.as_ref().unwrap();
    assert_eq!(model.samples_used, 1000);
}

#[test]
fn an_entry_is_read_as_it_always_was_and_refused_where_it_cannot_be() {
    let read = |json: &str| serde_json::from_str::<LogbookEntry>(json);
    let plain = r#"{"from":"2026-03-01T00:00:00Z","kind":"magnetic_cargo"}"#;
    let expected = entry(LogbookKind::MagneticCargo, 0, None);
    assert_eq!(read(plain).unwrap(), expected);
    let back = serde_json::to_string(&expected).unwrap();
    assert_eq!(read(&back).unwrap(), expected);
    let steel = r#"{"from":"2026-03-01T00:00:00Z","kind":"magnetic_cargo","cargo":"steel"}"#;
    assert_eq!(read(steel).unwrap().cargo, Some(Cargo::Steel));

    let refusal = |json: &str| read(json).unwrap_err().to_string();
    let turned = plain.replace("kind", r#"to":"2026-02-28T00:00:00Z","kind"#);
    let told = refusal(&turned);
    assert!(
        told.starts_with("to: 2026-02-28T00:00:00Z is before from"),
        "{told}"
    );
    let told = refusal(&steel.replace("magnetic_cargo", "shock"));
    assert!(told.starts_with("cargo: "), "{told}");
    assert!(read(&plain.replace("magnetic_cargo", "ufo")).is_err());
}

#[test]
fn a_wild_gyro_reading_is_doubted_and_named() {
    let mut samples = voyage();
    for index in [200, 500, 800] {
        let gyro = samples[index].gyro.unwrap().degrees();
        samples[index].gyro = TrueHeading::new(gyro + 10.0);
    }
    samples[300].gyro = None;
    let analysis = run(&samples);
    for index in [200, 500, 800] {
        assert_eq!(analysis.samples[index].reason, Some(SampleReason::Outlier));
        assert!((analysis.samples[index].residual_deg.unwrap() - 10.0).abs() < 0.5);
    }
    assert_eq!(
        analysis.samples[300].reason,
        Some(SampleReason::NoReference)
    );
    assert_eq!(
        analysis.epochs[0].model.as_ref().unwrap().samples_rejected,
        4
    );
}

#[test]
fn after_a_repair_what_was_learnt_before_still_counts() {
    // A year in both hemispheres, then a few hours in one place.
    let samples: Vec<Sample> = voyage()
        .into_iter()
        .filter(|s| s.time < time(9000))
        .collect();
    let few: Vec<Sample> = (0..60_i32)
        .map(|i| sample(9000 + 10 * i64::from(i), 30.0, f64::from(i * 47 % 360)))
        .collect();
    let all: Vec<Sample> = samples.iter().chain(&few).copied().collect();
    let repair = LogbookEntry {
        from: time(9000),
        to: None,
        kind: LogbookKind::Repair,
        cargo: None,
        note: String::new(),
    };
    let moved = LogbookEntry {
        kind: LogbookKind::CompassMoved,
        ..repair.clone()
    };
    let chi13_sd = |entry: &LogbookEntry| {
        let analysis = analyse(
            &all,
            std::slice::from_ref(entry),
            &AnalysisSettings::default(),
        );
        analysis.epochs[1]
            .model
            .as_ref()
            .unwrap()
            .covariance
            .unwrap()[1][1]
            .sqrt()
    };
    assert!(chi13_sd(&repair) < 0.6 * chi13_sd(&moved));
}

/// The voyage with a satellite compass beside the gyro.
fn with_satellite() -> Vec<Sample> {
    voyage()
        .iter()
        .map(|s| Sample {
            satellite: s.gyro,
            ..*s
        })
        .collect()
}

#[test]
fn a_gyro_fault_is_not_put_down_to_the_compass() {
    let sound = run(&with_satellite());
    let mut faulty = with_satellite();
    for sample in &mut faulty[600..] {
        let gyro = sample.gyro.unwrap().degrees();
        sample.gyro = TrueHeading::new(gyro + 5.0);
    }
    let found = run(&faulty);
    let parameters = |analysis: &Analysis| {
        analysis.epochs[0]
            .model
            .as_ref()
            .unwrap()
            .parameters_over_lambda
            .to_array()
    };
    let within = [30.0, 1e-3, 30.0, 1e-3, 1e-3, 1e-3, 1e-3];
    for ((a, b), within) in parameters(&sound)
        .iter()
        .zip(parameters(&found))
        .zip(within)
    {
        assert!((a - b).abs() < within, "{a} and {b}");
    }
    let constant = found.epochs[0].model.as_ref().unwrap().constant_deg;
    assert!(constant.abs() < 0.1, "{constant}");
}

#[test]
fn two_references_narrow_the_constant_and_their_quarrel_widens_it() {
    let sd = |samples: &[Sample]| {
        let model = run(samples).epochs[0].model.clone().unwrap();
        let covariance = model.covariance.unwrap();
        // A and the constant together.
        let a = [5, 6].map(|j| if j == 6 { 0.5_f64 } else { -0.5 }.to_degrees());
        let mut variance =
            covariance[7][7] + 2.0 * (a[0] * covariance[5][7] + a[1] * covariance[6][7]);
        for (i, x) in [5, 6].into_iter().zip(a) {
            for (j, y) in [5, 6].into_iter().zip(a) {
                variance += x * covariance[i][j] * y;
            }
        }
        variance.sqrt()
    };
    let (one, two) = (sd(&voyage()), sd(&with_satellite()));
    let quarrel: Vec<Sample> = with_satellite()
        .iter()
        .map(|s| Sample {
            satellite: s
                .satellite
                .and_then(|h| TrueHeading::new(h.degrees() + 2.0)),
            ..*s
        })
        .collect();
    assert!(two < 0.85 * one, "{two} {one}");
    assert!(sd(&quarrel) > 0.95, "{}", sd(&quarrel));
}

/// The constant of two references is known better than that of one: what stood in the
/// model before is taken off, not what stands in the one after.
#[test]
fn after_a_repair_with_one_reference_left_the_epoch_is_fitted_all_the_same() {
    let both_then_one: Vec<Sample> = with_satellite()
        .into_iter()
        .map(|s| Sample {
            satellite: s.satellite.filter(|_| s.time < time(5000)),
            ..s
        })
        .collect();
    let repair = LogbookEntry {
        from: time(5000),
        to: None,
        kind: LogbookKind::Repair,
        cargo: None,
        note: String::new(),
    };
    let analysis = analyse(&both_then_one, &[repair], &AnalysisSettings::default());
    let [before, after] = &analysis.epochs[..] else {
        panic!("{} epochs", analysis.epochs.len());
    };
    assert!(before.model.is_some());
    let refusal = &after.refusal;
    let covariance = after
        .model
        .as_ref()
        .unwrap_or_else(|| panic!("{refusal:?}"))
        .covariance;
    assert!(
        covariance.unwrap()[7][7] > 0.25,
        "one reference's constant stands in it"
    );
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
    assert!(model.rms_deg.unwrap() < 0.1);
}
