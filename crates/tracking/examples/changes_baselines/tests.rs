//! Predictions of the bound and of the detectors.

use crate::bocpd::Runs;
use crate::cusum::Sums;
use crate::ship::is_alarm;
use crate::voyages::bound::{fair, noise};
use crate::voyages::fleet::{Event, Plan, sail_log};
use crate::voyages::lorden::{Readings, Row, information};
use crate::voyages::{Faults, Variety};
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use nalgebra::{DVector, Vector2};

fn row(end: i64, shift_deg: f64) -> Row {
    Row {
        end,
        miles: 2.0,
        cos_lat: 0.8,
        h_nt: 24_000.0,
        northerly_deg: 1.0,
        shift_deg,
    }
}

#[test]
fn in_white_noise_every_row_tells_half_the_square_of_the_shift_in_variances() {
    let nothing = Faults {
        schuler_deg: 0.0,
        slow_gyro_deg: 0.0,
        variation_deg: 0.0,
        swing_deg: 0.0,
        speed_error: 0.0,
        ..Faults::USUAL
    };
    let rows: Vec<Row> = (1..=5).map(|k| row(10 * k, 0.3)).collect();
    let readings = Readings {
        white_deg: [1.0, 2.0, 2.0],
        multipath_deg: 0.0,
    };
    let reported = information(&rows, &[], &nothing, readings);
    // Means of ten; the compass's noise in both references, the mean of which is best.
    let variance = (1.0 + (4.0 + 4.0) / 4.0) / 10.0;
    for (k, ratio) in reported.into_iter().enumerate() {
        let expected = (k + 1) as f64 * 0.3 * 0.3 / (2.0 * variance);
        assert!((ratio - expected).abs() < 1e-9, "{ratio} is not {expected}");
    }
}

#[test]
fn by_a_gyro_alone_the_information_is_that_of_the_dense_covariance() {
    let sizes = Faults {
        drift_nt: 0.0,
        ..Faults::USUAL
    };
    let voyage = fair(3, Variety::Medium, 3.0, &sizes);
    let o = &voyage.observations;
    let changed = o.len() / 2;
    let minute = |k: usize| (o[k].time.unwrap().seconds_since(voyage.start) / 60.0).round() as i64;
    let rows: Vec<Row> = (0..o.len())
        .map(|k| {
            let (lat, sog_kn) = (o[k].position.unwrap().lat_deg(), o[k].sog_kn.unwrap());
            let cos_lat = lat.to_radians().cos();
            let heading = o[k].compass.degrees() + o[k].deviation.degrees_east();
            let heading = (heading + o[k].variation.degrees_east()).to_radians();
            let minutes = minute(k) - if k == 0 { 0 } else { minute(k - 1) };
            Row {
                miles: minutes as f64 / 60.0 * sog_kn,
                cos_lat,
                h_nt: o[k].h_nt,
                northerly_deg: (sog_kn / 902.5 / cos_lat * heading.cos()).to_degrees(),
                ..row(minute(k), if k < changed { 0.0 } else { 1.0 })
            }
        })
        .collect();
    let blind = Readings {
        white_deg: [0.35, 0.15, 1e6],
        ..Readings::USUAL
    };
    let reported = information(&rows, &voyage.turns, &voyage.sizes, blind);
    for until in [changed + 1, changed + 10, o.len()] {
        let covariance = noise(&voyage).view((0, 0), (until, until)).into_owned();
        let shift = DVector::from_fn(until, |k, _| rows[k].shift_deg);
        let expected = shift.dot(&covariance.cholesky().unwrap().solve(&shift)) / 2.0;
        let found = reported[until - 1];
        assert!(
            (found / expected - 1.0).abs() < 0.05,
            "after {until} rows {found} log-likelihood ratio, not {expected}"
        );
    }
}

#[test]
fn a_cumulative_sum_counts_what_exceeds_the_slack_in_its_own_quadrant() {
    let mut sums = Sums::default();
    let taken = [
        (10.0, 2.0, 1.5),
        (10.0, 1.0, 2.0),
        // Downwards now.
        (10.0, -3.0, 2.5),
        (10.0, 0.5, 1.5),
        (100.0, 1.0, 0.5),
        (350.0, -0.7, 0.2),
    ];
    for (compass_deg, innovation, expected) in taken {
        let found = sums.take(compass_deg, innovation);
        assert!(
            (found - expected).abs() < 1e-12,
            "{found} is not {expected}"
        );
    }
}

#[test]
fn of_two_hours_the_run_lengths_are_those_of_bayes_rule() {
    let mut runs = Runs::new(0.5);
    let load = Vector2::new(2.0, 0.0);
    runs.take(0.3, load);
    runs.take(-1.9, load);
    // Residuals of variance 0.25, the step's of variance 4: together, correlated by the
    // step, in one run; each alone, in two.
    let alone = |x: f64| -x * x / (2.0 * 4.25) - 4.25_f64.ln() / 2.0;
    let (a, b) = (0.3, -1.9);
    let determinant = 4.25 * 4.25 - 16.0;
    let squares = (4.25 * (a * a + b * b) - 2.0 * 4.0 * a * b) / determinant;
    let together = -squares / 2.0 - f64::ln(determinant) / 2.0;
    let hazard = 1.0 / (5.0 * 365.25 * 24.0);
    let apart = hazard * f64::exp(alone(a) + alone(b) - together) / (1.0 - hazard);
    let expected = apart / (1.0 + apart);
    // After the second hour: a run of one hour, beside that which begins with the next.
    let found = runs.is_younger(2) - hazard;
    assert!(
        (found / (expected * (1.0 - hazard)) - 1.0).abs() < 1e-6,
        "{found:e} is not {expected:e}"
    );
}

#[test]
fn what_the_product_is_said_to_tell_at_a_time_it_tells_from_the_samples_so_far() {
    let plan = Plan {
        days: 45.0,
        event_day: 25.0,
        ..Plan::new(Event::Step(2000.0), Variety::Medium)
    };
    let samples = sail_log(1, &plan).samples;
    let run = |samples: &[Sample]| {
        binnacle_tracking::analyse(&binnacle_tracking::Input {
            samples,
            logbook: &[],
            azimuths: &[],
            prior: &ShipPrior::population(),
            settings: AnalysisSettings::default(),
        })
    };
    let reported_at = |samples: &[Sample]| {
        let reported = run(samples).changes;
        reported.iter().find(|c| is_alarm(c)).map(|c| c.detected_at)
    };
    let at = reported_at(&samples).expect("a step of 2 µT is reported");
    let until = samples.partition_point(|s| s.time <= at);
    assert_eq!(reported_at(&samples[..until]), Some(at));
    assert_eq!(reported_at(&samples[..until - 1]), None);
}
