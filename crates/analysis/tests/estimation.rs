//! Honesty and width of the estimator's band, judged on voyages from a generator that
//! shares nothing with it.

#![allow(clippy::unwrap_used)] // all of this is tests

mod voyages;

use binnacle_analysis::fit::{Observation, RobustOptions, fit_robust};
use binnacle_compass::angle::{CompassHeading, Deviation, wrap_180};
use binnacle_compass::model::{Caution, Model};
use voyages::tally::Tally;
use voyages::{Faults, Truth, Variety, predicted, sail, true_deviation};

fn fleet(seeds: std::ops::Range<u64>, variety: Variety, days: f64, faults: &Faults) -> Tally {
    let mut sum = Tally::default();
    for seed in seeds {
        sum.merge(&Tally::from_voyage(seed, variety, days, faults));
    }
    sum
}

fn fitted(observations: &[Observation]) -> Model {
    fit_robust(observations, &RobustOptions::default())
        .unwrap()
        .model
}

/// A small fleet of each kind, sixty days at sea.
#[test]
fn the_band_holds_the_truth_on_nine_headings_in_ten() {
    for variety in [Variety::Rich, Variety::Medium, Variety::Poor] {
        let tally = fleet(1000..1006, variety, 60.0, &Faults::USUAL);
        assert_eq!(tally.refused, 0, "{variety:?}");
        assert!(tally.own.share() > 0.9, "{variety:?}: {tally:?}");
        assert!(tally.away.share() > 0.9, "{variety:?}: {tally:?}");
        // Honest, and narrow beside the reference's own constant.
        let error = tally.own_shape.rms();
        assert!(error < 0.4, "{variety:?}: {error}");
    }
}

#[test]
fn a_satellite_compass_beside_the_gyro_narrows_the_band_and_it_still_holds() {
    let alone = fleet(1100..1106, Variety::Medium, 30.0, &Faults::USUAL);
    let both = Faults {
        satellite: true,
        ..Faults::USUAL
    };
    let both = fleet(1100..1106, Variety::Medium, 30.0, &both);
    assert!(both.own_shape.se() < 0.7 * alone.own_shape.se());
    assert!(both.own_shape.share() > 0.85, "{both:?}");
    assert!(both.own.share() > 0.9, "{both:?}");
}

#[test]
fn one_wild_reading_in_thirty_does_no_harm() {
    let wild = Faults {
        outliers: 0.015,
        ..Faults::USUAL
    };
    let tally = fleet(2000..2003, Variety::Medium, 60.0, &wild);
    assert_eq!((tally.refused, tally.passed), (0, tally.ships));
}

/// One row in ten is 20° off by one instrument, and always to the same side. The first
/// three are the voyages that suffered most while a wild reading passed for a turn.
#[test]
fn one_reading_in_ten_that_is_20_degrees_out_moves_the_prediction_by_less_than_a_third() {
    for (seed, variety) in [
        (8001, Variety::Rich),
        (8023, Variety::Rich),
        (8049, Variety::Medium),
        (2102, Variety::Poor),
    ] {
        let voyage = sail(seed, variety, 30.0, &Faults::USUAL);
        let before = fitted(&voyage.observations);
        for is_compass in [false, true] {
            let mut disturbed = voyage.observations.clone();
            for observation in disturbed.iter_mut().step_by(10) {
                let wrong = observation.deviation.degrees_east() + 20.0;
                observation.deviation = Deviation::new(wrong).unwrap();
                if is_compass {
                    let wrong = observation.compass.degrees() - 20.0;
                    observation.compass = CompassHeading::new(wrong.rem_euclid(360.0)).unwrap();
                }
            }
            let after = fitted(&disturbed);
            let Truth { h_nt, z_nt, .. } = voyage.truth;
            for heading in 0..36 {
                let compass = f64::from(heading) * 10.0;
                let moved = predicted(&after, compass, h_nt, z_nt).0
                    - predicted(&before, compass, h_nt, z_nt).0;
                assert!(moved.abs() < 0.25, "{seed} {is_compass} {compass}: {moved}");
            }
        }
    }
}

#[test]
fn a_gyros_constant_error_goes_to_the_constant_and_leaves_the_magnetism_alone() {
    for (seed, variety) in [
        (2200, Variety::Rich),
        (2201, Variety::Medium),
        (2202, Variety::Poor),
    ] {
        let voyage = sail(seed, variety, 30.0, &Faults::USUAL);
        let mut off = voyage.observations.clone();
        for observation in &mut off {
            let wrong = observation.deviation.degrees_east() + 1.5;
            observation.deviation = Deviation::new(wrong).unwrap();
        }
        let (right, wrong) = (fitted(&voyage.observations), fitted(&off));
        let (a, b) = (
            right.parameters_over_lambda.to_array(),
            wrong.parameters_over_lambda.to_array(),
        );
        let covariance = right.covariance.unwrap();
        for j in 0..7 {
            let se = covariance[j][j].sqrt();
            assert!((a[j] - b[j]).abs() < se, "{variety:?}, parameter {j}");
        }
        // The deviation as the user sees it moves by that much: A and constant together.
        let moved = |model: &Model| {
            let p = model.parameters_over_lambda;
            model.constant_deg + ((p.chi21 - p.chi12) / 2.0).to_degrees()
        };
        assert!((moved(&wrong) - moved(&right) - 1.5).abs() < 0.2);
    }
}

#[test]
fn a_ship_of_one_sea_says_what_she_cannot_know() {
    for seed in 3000..3004 {
        let mut voyage = sail(seed, Variety::Poor, 60.0, &Faults::USUAL);
        let home = voyage.observations[0].z_nt / voyage.observations[0].h_nt;
        voyage
            .observations
            .retain(|o| (o.z_nt / o.h_nt / home - 1.0).abs() < 0.04);
        let model = fitted(&voyage.observations);
        let reported = model.identifiable.unwrap();
        assert!(
            !(reported.bx_nt || reported.chi13 || reported.by_nt || reported.chi23),
            "{reported:?}"
        );
        assert!(reported.chi11_minus_chi22, "{reported:?}");
        let quality = model.quality.clone().unwrap();
        assert!(quality.cautions.contains(&Caution::OneMagneticLatitude));

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
    let model = fitted(&voyage.observations);
    let reported = model.identifiable.unwrap();
    assert!(
        reported.bx_nt && reported.chi13 && reported.by_nt && reported.chi23,
        "{reported:?}"
    );
    assert!(reported.chi11_minus_chi22, "{reported:?}");
    // A mixes with the constant: of these two only the sum is known.
    assert!(
        !reported.chi12 && !reported.chi21 && !reported.constant_deg,
        "{reported:?}"
    );
    let quality = model.quality.unwrap();
    assert_eq!(quality.cautions, []);
    assert!(quality.from_data.bx_nt > 0.9 && quality.from_data.chi11_minus_chi22 > 0.9);
}

/// A gyro repeats its errors: thousands of samples are worth some hundreds.
#[test]
fn samples_are_worth_fewer_than_they_are_many_and_more_are_worth_more() {
    let voyage = sail(4100, Variety::Medium, 60.0, &Faults::USUAL);
    let half = voyage.observations.len() / 2;
    let worth = |observations: &[Observation]| {
        let quality = fitted(observations).quality.unwrap();
        assert!(quality.condition.is_some_and(|c| c > 1.0), "{quality:?}");
        quality.effective_samples
    };
    let (some, all) = (
        worth(&voyage.observations[..half]),
        worth(&voyage.observations),
    );
    assert!(1.0 < some && some < all && all < 0.2 * voyage.observations.len() as f64);
}

#[test]
fn a_year_of_drift_is_followed() {
    let restless = Faults {
        drift_nt: 150.0,
        ..Faults::USUAL
    };
    let tally = fleet(5000..5002, Variety::Medium, 200.0, &restless);
    assert_eq!((tally.refused, tally.passed), (0, tally.ships));
}

/// Three degrees of alignment error are far out for a compass, and must be accepted.
#[test]
fn a_compass_that_is_bolted_down_askew_is_found_out() {
    for seed in 6000..6003 {
        let mut voyage = sail(seed, Variety::Medium, 45.0, &Faults::USUAL);
        let askew = 4.0;
        for observation in &mut voyage.observations {
            let compass = observation.compass.degrees() - askew;
            observation.compass = binnacle_compass::angle::CompassHeading::new(compass).unwrap();
            let deviation = observation.deviation.degrees_east() + askew;
            observation.deviation = Deviation::new(deviation).unwrap();
        }
        voyage.truth.alignment_deg += askew;
        let model = fitted(&voyage.observations);
        let Truth { h_nt, z_nt, .. } = voyage.truth;
        let held = (0..36).filter(|k| {
            let compass = f64::from(*k) * 10.0;
            let (deviation, se) = predicted(&model, compass, h_nt, z_nt);
            let truth = true_deviation(&voyage.truth, compass, h_nt, z_nt);
            wrap_180(deviation - truth).abs() <= 1.96 * se
        });
        assert!(held.count() >= 33, "{seed}");
    }
}

/// Both hemispheres in twenty samples: latitudes are not missing.
#[test]
fn too_few_samples_are_not_taken_for_too_few_latitudes() {
    for seed in 2400..2404 {
        let voyage = sail(seed, Variety::Rich, 30.0, &Faults::USUAL);
        let every = voyage.observations.len() / 20;
        let few: Vec<Observation> = voyage.observations.iter().step_by(every).copied().collect();
        let cautions = fitted(&few).quality.unwrap().cautions;
        assert!(
            !cautions.contains(&Caution::OneMagneticLatitude),
            "{cautions:?}"
        );
        assert!(cautions.contains(&Caution::FewSamples), "{cautions:?}");
    }
}
