//! Is the estimator's band honest, and is it narrow? Judged on voyages it has
//! never seen, by a generator that shares nothing with it.

#![allow(clippy::unwrap_used)] // all of this is tests

mod voyages;

use binnacle_magnetics::angle::wrap_180;
use binnacle_magnetics::fit::{RobustOptions, fit_robust};
use voyages::tally::Tally;
use voyages::{Faults, Truth, Variety, predicted, sail, true_deviation};

/// A small fleet of each kind, sixty days at sea.
#[test]
fn the_band_holds_the_truth_on_nine_headings_in_ten() {
    for variety in [Variety::Rich, Variety::Medium, Variety::Poor] {
        let mut tally = Tally::default();
        for seed in 1000..1004 {
            tally.add(seed, variety, 60.0, &Faults::USUAL);
        }
        assert_eq!(
            (tally.refused, tally.passed),
            (0, tally.ships),
            "{variety:?}"
        );
        // Honest, and narrow beside the reference's own constant.
        let error = (tally.shape_squares / f64::from(tally.headings)).sqrt();
        assert!(error < 0.4, "{variety:?}: {error}");
    }
}

#[test]
fn one_wild_reading_in_thirty_does_no_harm() {
    let mut tally = Tally::default();
    for seed in 2000..2003 {
        tally.add(
            seed,
            Variety::Medium,
            60.0,
            &Faults {
                outliers: 0.015,
                ..Faults::USUAL
            },
        );
    }
    assert_eq!((tally.refused, tally.passed), (0, tally.ships));
}

#[test]
fn a_ship_of_one_sea_says_what_she_cannot_know() {
    for seed in 3000..3004 {
        let mut voyage = sail(seed, Variety::Poor, 60.0, &Faults::USUAL);
        let home = voyage.observations[0].z_nt / voyage.observations[0].h_nt;
        voyage
            .observations
            .retain(|o| (o.z_nt / o.h_nt / home - 1.0).abs() < 0.04);
        let model = fit_robust(&voyage.observations, &RobustOptions::default())
            .unwrap()
            .model;
        let told = model.identifiable.unwrap();
        assert!(
            !(told.bx_nt || told.chi13 || told.by_nt || told.chi23),
            "{told:?}"
        );
        assert!(told.chi11_minus_chi22, "{told:?}");

        // At home the band is narrow; off the Cape it is wide, and holds.
        let Truth { h_nt, z_nt, .. } = voyage.truth;
        let (_, at_home) = predicted(&model, 90.0, h_nt, z_nt);
        let (_, far_away) = predicted(&model, 90.0, 12_000.0, -25_000.0);
        assert!(far_away > 2.0 * at_home, "{far_away} and {at_home}");
        for compass in [0.0, 90.0, 180.0, 270.0] {
            let (deviation, se) = predicted(&model, compass, 12_000.0, -25_000.0);
            let truth = true_deviation(&voyage.truth, compass, 12_000.0, -25_000.0);
            assert!(
                wrap_180(deviation - truth).abs() < 3.5 * se,
                "{seed} {compass}"
            );
        }
    }
}

#[test]
fn both_hemispheres_tell_all_but_what_mixes_with_the_constant() {
    let voyage = sail(4000, Variety::Rich, 60.0, &Faults::USUAL);
    let model = fit_robust(&voyage.observations, &RobustOptions::default())
        .unwrap()
        .model;
    let told = model.identifiable.unwrap();
    assert!(
        told.bx_nt && told.chi13 && told.by_nt && told.chi23,
        "{told:?}"
    );
    assert!(told.chi11_minus_chi22, "{told:?}");
    // A mixes with the constant: of these two only the sum is known.
    assert!(!told.chi12 && !told.chi21 && !told.constant_deg, "{told:?}");
}

#[test]
fn a_year_of_drift_is_followed() {
    let mut tally = Tally::default();
    for seed in 5000..5002 {
        tally.add(
            seed,
            Variety::Medium,
            200.0,
            &Faults {
                drift_nt: 150.0,
                ..Faults::USUAL
            },
        );
    }
    assert_eq!((tally.refused, tally.passed), (0, tally.ships));
}
