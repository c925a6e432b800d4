//! Ordinary least squares finds the parameters where its assumptions hold, and names what
//! is missing where they do not.

#![allow(clippy::unwrap_used)] // all of this is tests

#[allow(dead_code)]
mod voyages;

use binnacle_analysis::fit::{Observation, fit_ols, fit_paper};
use binnacle_compass::angle::{CompassHeading, Deviation, wrap_180};
use binnacle_compass::result::FitError;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use voyages::{Faults, Truth, Variety, gauss, predicted, sail, true_deviation};

/// A voyage whose deviations are exact but for independent errors of `sd_deg`.
fn textbook_voyage(seed: u64, sd_deg: f64) -> (Vec<Observation>, Truth) {
    let voyage = sail(seed, Variety::Rich, 20.0, &Faults::USUAL);
    let mut rows: Vec<Observation> = voyage.observations.into_iter().step_by(5).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for row in &mut rows {
        let exact = true_deviation(&voyage.truth, row.compass.degrees(), row.h_nt, row.z_nt);
        row.deviation = Deviation::new(exact + sd_deg * gauss(&mut rng)).unwrap();
    }
    (rows, voyage.truth)
}

fn headings() -> impl Iterator<Item = f64> {
    (0..36).map(|step| f64::from(step) * 10.0)
}

#[test]
fn exact_deviations_give_back_the_curve_everywhere() {
    for seed in 0..20 {
        let (rows, truth) = textbook_voyage(seed, 0.0);
        let model = fit_ols(&rows).unwrap();
        assert!(model.rms_deg.unwrap() < 1e-8, "{:?}", model.rms_deg);
        assert_eq!(model.samples_used, rows.len() as u64);
        // At home, on the line and off the Cape; an alignment error is in A.
        for (h, z) in [(18_000.0, 45_000.0), (28_000.0, 0.0), (12_000.0, -25_000.0)] {
            for compass in headings() {
                let expected = true_deviation(&truth, compass, h, z);
                let (found, _) = predicted(&model, compass, h, z);
                assert!(wrap_180(found - expected).abs() < 1e-5, "{seed} {compass}");
            }
        }
    }
}

#[test]
fn with_independent_noise_its_standard_errors_are_right() {
    let (mut squares, mut headings_seen) = (0.0, 0.0);
    for seed in 0..150 {
        let (rows, truth) = textbook_voyage(seed, 0.5);
        let model = fit_ols(&rows).unwrap();
        assert!((model.rms_deg.unwrap() - 0.5).abs() < 0.1);
        let Truth { h_nt, z_nt, .. } = truth;
        for compass in headings() {
            let (found, standard_error) = predicted(&model, compass, h_nt, z_nt);
            let error = wrap_180(found - true_deviation(&truth, compass, h_nt, z_nt));
            squares += (error / standard_error).powi(2);
            headings_seen += 1.0;
        }
    }
    let scatter: f64 = squares / headings_seen;
    assert!((0.85..1.15).contains(&scatter), "{scatter}");
}

#[test]
fn a_weight_of_two_is_the_row_twice_and_of_none_the_row_left_out() {
    let (rows, _) = textbook_voyage(7, 0.5);
    let times = |index: usize| [2_u8, 0, 1][index % 3];
    let mut weighed = rows.clone();
    for (index, row) in weighed.iter_mut().enumerate() {
        row.weight = f64::from(times(index));
    }
    let listed = rows.iter().enumerate();
    let listed: Vec<Observation> = listed
        .flat_map(|(index, row)| std::iter::repeat_n(*row, times(index).into()))
        .collect();
    let (weighed, listed) = (fit_ols(&weighed).unwrap(), fit_ols(&listed).unwrap());
    assert_eq!(weighed.samples_rejected, (rows.len() as u64 + 1) / 3);
    for compass in headings() {
        let (by_weight, _) = predicted(&weighed, compass, 20_000.0, 40_000.0);
        let (by_list, _) = predicted(&listed, compass, 20_000.0, 40_000.0);
        assert!((by_weight - by_list).abs() < 1e-7, "{compass}");
    }
}

#[test]
fn noise_in_angle_is_better_answered_in_angle() {
    // The paper's rows weigh force: where H is small, noise counts more.
    let error = |fit: fn(&[Observation]) -> Result<_, FitError>| {
        let ships = (0..40).map(|seed| {
            let (rows, truth) = textbook_voyage(seed, 1.0);
            let model = fit(&rows).unwrap();
            let off = headings().map(|compass| {
                let expected = true_deviation(&truth, compass, truth.h_nt, truth.z_nt);
                let (found, _) = predicted(&model, compass, truth.h_nt, truth.z_nt);
                wrap_180(found - expected).powi(2)
            });
            off.sum::<f64>()
        });
        ships.sum::<f64>()
    };
    assert!(error(fit_ols) < error(fit_paper));
}

#[test]
fn what_is_missing_is_named() {
    let (rows, _) = textbook_voyage(3, 0.2);
    assert_eq!(
        fit_ols(&rows[..7]),
        Err(FitError::TooFewSamples {
            found: 7,
            needed: 8
        })
    );

    let mut one_heading = rows.clone();
    for row in &mut one_heading {
        row.compass = CompassHeading::new(40.0).unwrap();
    }
    let refused = fit_ols(&one_heading).unwrap_err();
    assert!(
        matches!(refused, FitError::TooFewHeadings { found: 1, .. }),
        "{refused}"
    );

    let mut one_latitude = rows.clone();
    for row in &mut one_latitude {
        (row.h_nt, row.z_nt) = (24_000.0, 39_000.0);
    }
    assert_eq!(fit_ols(&one_latitude), Err(FitError::OneMagneticLatitude));

    // A magnet stronger than the earth's field: the card follows the ship.
    let mut stuck = rows;
    for (index, row) in stuck.iter_mut().enumerate() {
        let magnetic = index as f64 * 7.0;
        row.deviation = Deviation::new(magnetic - row.compass.degrees()).unwrap();
    }
    let refused = fit_ols(&stuck).unwrap_err();
    assert!(
        matches!(
            refused,
            FitError::AmbiguousHeadings { .. } | FitError::NotConverged
        ),
        "{refused}"
    );
}

#[test]
fn a_row_in_a_field_too_weak_for_a_compass_is_left_out_and_all_such_are_refused() {
    let (rows, _) = textbook_voyage(3, 0.2);
    for fit in [fit_ols, fit_paper] {
        let expected = fit(&rows).unwrap();
        let mut beside = rows.clone();
        let mut weak = rows[0];
        (weak.h_nt, weak.deviation) = (1_500.0, Deviation::new(80.0).unwrap());
        let mut without_weight = weak;
        (without_weight.h_nt, without_weight.weight) = (24_000.0, 0.0);
        beside.extend([weak, without_weight]);
        let found = fit(&beside).unwrap();
        assert_eq!(
            found.parameters_over_lambda,
            expected.parameters_over_lambda
        );
        assert_eq!(found.samples_rejected, 2);

        let all_weak: Vec<Observation> = rows
            .iter()
            .map(|o| Observation {
                h_nt: 1_500.0,
                ..*o
            })
            .collect();
        let refused = fit(&all_weak).unwrap_err();
        assert!(
            matches!(refused, FitError::FieldTooWeak { .. }),
            "{refused}"
        );
    }
}
