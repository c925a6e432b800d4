//! One reference, two, and their faults.

use super::*;
use binnacle_compass::model::{Model, VariationMistake};

#[test]
fn a_wild_gyro_reading_is_rejected_and_named() {
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
fn a_reference_made_of_the_compass_is_refused_by_name() {
    let made_of = |sample: &Sample| {
        let at = (sample.position, 0.0, sample.time);
        let earth = field(FieldModel::Igrf14, at.0, at.1, at.2).unwrap();
        TrueHeading::new(sample.compass.degrees() + earth.declination().degrees_east())
    };
    let base = with_satellite();
    let by_gyro = base.iter().map(|s| Sample {
        gyro: made_of(s),
        satellite: None,
        ..*s
    });
    let beside_a_gyro = base.iter().map(|s| Sample {
        satellite: made_of(s),
        ..*s
    });
    let voyages: [Vec<Sample>; 2] = [by_gyro.collect(), beside_a_gyro.collect()];
    for samples in voyages {
        let analysis = run(&samples);
        let epoch = &analysis.epochs[0];
        assert!(epoch.model.is_none());
        let refusal = &epoch.refusal;
        assert!(
            matches!(
                refusal,
                Some(FitError::ReferenceIsCompass { samples: 1000, .. })
            ),
            "{refusal:?}"
        );
        let reason = Some(SampleReason::ReferenceFailed);
        assert!(
            analysis
                .samples
                .iter()
                .all(|s| !s.used && s.reason == reason)
        );
    }
    assert_eq!(run(&base).epochs[0].refusal, None);
}

#[test]
fn nothing_is_made_of_a_refused_reference() {
    let mut samples = voyage();
    for sample in &mut samples {
        let earth = field(FieldModel::Igrf14, sample.position, 0.0, sample.time).unwrap();
        let variation_deg = earth.declination().degrees_east();
        let gyro = sample.gyro.unwrap().degrees();
        // The variation subtracted where it is added.
        sample.gyro = TrueHeading::new(gyro - 2.0 * variation_deg);
    }
    let analysis = run(&samples);
    let [epoch] = analysis.epochs.as_slice() else {
        panic!("{:?}", analysis.epochs);
    };
    let is_named = matches!(
        epoch.refusal,
        Some(FitError::VariationMistaken {
            mistake: VariationMistake::WrongSign,
            ..
        })
    );
    assert!(is_named, "{:?}", epoch.refusal);
    assert_eq!(epoch.model, None);
    assert_eq!(analysis.changes, []);
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
fn two_references_know_the_constant_better_than_one() {
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
    assert!(two < 0.85 * one, "{two} {one}");
}

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
    let analysis = analyse_with(&both_then_one, &[repair], &AnalysisSettings::default());
    let [before, after] = &analysis.epochs[..] else {
        panic!("{} epochs", analysis.epochs.len());
    };
    assert!(before.model.is_some());
    let refusal = &after.refusal;
    let model = after.model.as_ref();
    let model = model.unwrap_or_else(|| panic!("{refusal:?}"));
    let variance = |model: &Model| model.covariance.unwrap()[7][7];
    // What both showed of the compass's alignment is not forgotten.
    let both = variance(before.model.as_ref().unwrap());
    assert!(variance(model) >= 0.99 * both, "{} {both}", variance(model));
}
