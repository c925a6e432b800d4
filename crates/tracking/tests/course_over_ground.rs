//! Analyses of simulated ships that have neither gyro nor satellite compass.

#![allow(clippy::unwrap_used)] // all of this is tests

mod drifting_ship;

use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading, wrap_180};
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::result::{Analysis, Cause, Change, FitError, SampleReason};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::ship::EarthField;
use binnacle_tracking::validation::validate;
use binnacle_tracking::{Input, analyse};
use drifting_ship::{Plan, Voyage, sail};
use std::sync::LazyLock;

const SOUND: Plan = Plan {
    days: 60.0,
    realigned: None,
    drifts: false,
};

fn input(samples: &[Sample]) -> Input<'_> {
    static PRIOR: LazyLock<ShipPrior> = LazyLock::new(ShipPrior::population);
    Input {
        samples,
        logbook: &[],
        azimuths: &[],
        prior: &PRIOR,
        settings: AnalysisSettings::default(),
    }
}

fn run(samples: &[Sample]) -> Analysis {
    analyse(&input(samples))
}

fn ship_changes(analysis: &Analysis) -> Vec<&Change> {
    let changes = analysis.changes.iter();
    changes
        .filter(|change| change.confirmed && change.cause.changes_deviation())
        .collect()
}

/// Band of a model against the truth, over 36 headings at the ship's place.
#[derive(Clone, Copy, Debug)]
struct Checked {
    /// Share of headings whose band holds the truth.
    held: f64,
    /// Half the width of the band, and the error: root mean squares, degrees.
    half_width_deg: f64,
    error_deg: f64,
}

fn checked(analysis: &Analysis, voyage: &Voyage) -> Checked {
    let model = analysis.current_epoch().unwrap().model.as_ref().unwrap();
    let place = analysis.last_place.unwrap();
    let earth = EarthField {
        h_nt: place.h_nt,
        z_nt: place.z_nt,
    };
    let mut checked = Checked {
        held: 0.0,
        half_width_deg: 0.0,
        error_deg: 0.0,
    };
    for k in 0..36 {
        let compass_deg = 10.0 * f64::from(k);
        let compass = CompassHeading::new(compass_deg).unwrap();
        let predicted = model.deviation(compass, earth).unwrap();
        let half = 1.96 * predicted.standard_error_deg.unwrap();
        let off = predicted.deviation.degrees_east() - voyage.deviation_deg(compass_deg);
        checked.held += f64::from(u8::from(wrap_180(off).abs() <= half)) / 36.0;
        checked.half_width_deg += half * half / 36.0;
        checked.error_deg += off * off / 36.0;
    }
    checked.half_width_deg = checked.half_width_deg.sqrt();
    checked.error_deg = checked.error_deg.sqrt();
    checked
}

#[test]
fn a_wide_band_holds_the_truth_and_most_ships_have_no_change() {
    let ships: Vec<(Checked, bool)> = (1..=24)
        .map(|seed| {
            let voyage = sail(seed, &SOUND);
            let analysis = run(&voyage.samples);
            let changed = !ship_changes(&analysis).is_empty();
            (checked(&analysis, &voyage), changed)
        })
        .collect();
    let mean = |of: fn(&Checked) -> f64| {
        ships.iter().map(|(ship, _)| of(ship)).sum::<f64>() / ships.len() as f64
    };
    let (held, half_width_deg) = (mean(|c| c.held), mean(|c| c.half_width_deg));
    assert!((0.90..0.99).contains(&held), "{held}");
    assert!((2.0..6.0).contains(&half_width_deg), "{half_width_deg}");
    let changed = ships.iter().filter(|(_, changed)| *changed).count();
    assert!(changed <= 6, "{changed}");
}

#[test]
fn a_compass_turned_by_ten_degrees_is_found_within_days() {
    let found = (31..=42).filter(|seed| {
        let plan = Plan {
            realigned: Some((30.0, 10.0)),
            ..SOUND
        };
        let voyage = sail(*seed, &plan);
        let turned = voyage.samples[0].time.plus_seconds(30.0 * 86_400.0);
        let analysis = run(&voyage.samples);
        let changes = ship_changes(&analysis);
        changes.iter().any(|change| {
            change.cause == Cause::Alignment
                && change.from.seconds_since(turned).abs() < 86_400.0
                && change.detected_at.seconds_since(turned) < 4.0 * 86_400.0
        })
    });
    let found = found.count();
    assert!(found >= 10, "{found} of 12");
}

#[test]
fn a_drifting_ship_is_refused_by_name() {
    let plan = Plan {
        drifts: true,
        days: 10.0,
        ..SOUND
    };
    let analysis = run(&sail(51, &plan).samples);
    let epoch = analysis.current_epoch().unwrap();
    assert_eq!(epoch.model, None);
    let Some(FitError::NoSteadyCourse {
        readings,
        found: 0,
        too_slow,
        ..
    }) = epoch.refusal
    else {
        panic!("{:?}", epoch.refusal);
    };
    assert_eq!((readings, too_slow), (1440, 1440));
    let slow = Some(SampleReason::TooSlowForCourse);
    assert!(analysis.samples.iter().all(|s| !s.used && s.reason == slow));
    assert!(
        analysis.notices[0].contains("1440 are slower"),
        "{:?}",
        analysis.notices
    );
}

#[test]
fn a_course_made_of_the_compass_is_refused() {
    let plan = Plan {
        days: 15.0,
        ..SOUND
    };
    let mut samples = sail(54, &plan).samples;
    let variations: Vec<f64> = run(&samples)
        .samples
        .iter()
        .map(|s| s.variation_deg.unwrap())
        .collect();
    for (sample, variation_deg) in samples.iter_mut().zip(variations) {
        sample.cog = CourseOverGround::new(sample.compass.degrees() + variation_deg);
    }
    let analysis = run(&samples);
    let refusal = analysis.current_epoch().unwrap().refusal.clone();
    let is_named = matches!(refusal, Some(FitError::ReferenceIsCompass { .. }));
    assert!(is_named, "{refusal:?}");
    assert_eq!(analysis.changes, []);
}

#[test]
fn the_model_says_its_grade_and_one_heading_makes_it_another() {
    let plan = Plan {
        days: 15.0,
        ..SOUND
    };
    let voyage = sail(52, &plan);
    let mut samples = voyage.samples.clone();
    let grade = |analysis: &Analysis| {
        let model = analysis.current_epoch().unwrap().model.clone();
        model.map(|model| model.reference_grade)
    };
    let by_course = run(&samples);
    assert_eq!(grade(&by_course), Some(ReferenceGrade::CourseOverGround));
    assert_eq!(by_course.epochs[0].references, None);
    // A gyro with errors of its own, even within ±0.3°.
    let errors = (0..500_i32).map(|k| 0.3 - 0.6 * (f64::from(k) * 0.618).fract());
    for ((sample, by_course), error_deg) in samples.iter_mut().zip(&by_course.samples).zip(errors) {
        let compass_deg = sample.compass.degrees();
        let magnetic_deg = compass_deg + voyage.deviation_deg(compass_deg);
        let true_deg = magnetic_deg + by_course.variation_deg.unwrap();
        sample.gyro = TrueHeading::new(true_deg + error_deg);
    }
    let by_heading = run(&samples);
    assert_eq!(grade(&by_heading), Some(ReferenceGrade::Heading));
    let later = &by_heading.samples[500..];
    let none = Some(SampleReason::NoReference);
    assert!(later.iter().all(|s| !s.used && s.reason == none));
}

#[test]
fn parts_of_a_recording_by_course_predict_each_other() {
    let voyage = sail(53, &SOUND);
    let validation = validate(&input(&voyage.samples));
    assert_eq!(validation.refusal, None);
    assert_eq!(validation.parts.len(), 4);
    for part in &validation.parts {
        let held_out = part.held_out.as_ref().unwrap();
        let (inside, least) = (held_out.courses_inside, held_out.expected_from);
        assert!(inside >= least, "{part:?}");
    }
}
