//! A compass whose zero lies anywhere: a sensor on its side or backwards, or a wrong offset.

#![allow(clippy::unwrap_used)] // all of this is tests

#[allow(dead_code, reason = "other tests use the rest")]
mod voyages;

use binnacle_analysis::fit::{Observation, RobustOptions, fit_ols, fit_paper, fit_robust};
use binnacle_compass::angle::{CompassHeading, Deviation, wrap_180};
use binnacle_compass::model::Model;
use binnacle_compass::result::FitError;
use voyages::{Faults, Truth, Variety, Voyage, predicted, sail, true_deviation};

/// Readings of the compass mounted so that it reads `by_deg` less.
fn turned(observations: &[Observation], by_deg: f64) -> Vec<Observation> {
    let turned = |o: &Observation| Observation {
        compass: CompassHeading::new(o.compass.degrees() - by_deg).unwrap(),
        deviation: Deviation::new(o.deviation.degrees_east() + by_deg).unwrap(),
        ..*o
    };
    observations.iter().map(turned).collect()
}

fn robust(observations: &[Observation]) -> Result<Model, FitError> {
    fit_robust(observations, &RobustOptions::default()).map(|fit| fit.model)
}

fn headings() -> impl Iterator<Item = f64> {
    (0..36).map(|step| f64::from(step) * 10.0)
}

/// Share of headings on which the bands of twenty ships, all turned by an angle, hold the
/// truth.
fn held(by_deg: f64, sail: impl Fn(u64) -> Voyage) -> f64 {
    let (mut held, mut looked_at) = (0, 0);
    for seed in 9000..9020 {
        let voyage = sail(seed);
        let observations = turned(&voyage.observations, by_deg);
        let model = match robust(&observations) {
            Ok(model) => model,
            // Two courses, out and home.
            Err(FitError::TooFewHeadings { .. }) => continue,
            Err(refused) => panic!("{seed}: {refused}"),
        };
        model.check().unwrap();
        let Truth { h_nt, z_nt, .. } = voyage.truth;
        let truth = Truth {
            alignment_deg: voyage.truth.alignment_deg + by_deg,
            ..voyage.truth
        };
        for compass in headings() {
            let (deviation, se) = predicted(&model, compass, h_nt, z_nt);
            let off = deviation - true_deviation(&truth, compass, h_nt, z_nt);
            held += u32::from(wrap_180(off).abs() <= 1.96 * se);
            looked_at += 1;
        }
    }
    assert!(looked_at > 15 * 36, "ships are refused");
    f64::from(held) / f64::from(looked_at)
}

#[test]
fn twenty_ships_at_each_angle_have_their_true_deviation_within_the_band() {
    for by_deg in [5.0, 10.0, 20.0, -30.0, 90.0, 180.0] {
        let share = held(by_deg, |seed| {
            let variety = [Variety::Rich, Variety::Medium, Variety::Poor][seed as usize % 3];
            sail(seed, variety, 20.0, &Faults::USUAL)
        });
        assert!(share >= 0.9, "{by_deg}: {share}");
    }
}

#[test]
fn a_few_days_on_one_sea_suffice_for_an_honest_band() {
    for by_deg in [0.0, 5.0, 7.0, 10.0, 30.0, 180.0] {
        let share = held(by_deg, |seed| {
            sail(seed, Variety::Poor, 6.0, &Faults::USUAL)
        });
        assert!(share >= 0.9, "{by_deg}: {share}");
    }
}

/// Half of the circle, so that the zero and the permanent magnetism look much alike.
#[test]
fn half_of_the_headings_suffice_for_an_honest_band() {
    for by_deg in [0.0, 10.0, -30.0, 90.0, 180.0] {
        let share = held(by_deg, |seed| {
            let mut voyage = sail(seed, Variety::Medium, 20.0, &Faults::USUAL);
            let alongside = 20.0 * seed as f64;
            voyage
                .observations
                .retain(|o| wrap_180(o.compass.degrees() - alongside).abs() < 90.0);
            voyage
        });
        assert!(share >= 0.9, "{by_deg}: {share}");
    }
}

#[test]
fn a_turned_voyage_gives_the_same_curve_and_band_at_its_angle() {
    for (seed, variety) in [
        (9100, Variety::Rich),
        (9101, Variety::Medium),
        (9102, Variety::Poor),
    ] {
        let voyage = sail(seed, variety, 30.0, &Faults::USUAL);
        let straight = robust(&voyage.observations).unwrap();
        for by_deg in [7.0, 13.0, 45.0, 90.0, 133.0, 180.0, -71.0, -170.0] {
            let model = robust(&turned(&voyage.observations, by_deg)).unwrap();
            let Truth { h_nt, z_nt, .. } = voyage.truth;
            for compass in headings() {
                let (a, a_se) = predicted(&straight, compass, h_nt, z_nt);
                let (b, b_se) = predicted(&model, compass - by_deg, h_nt, z_nt);
                let off = wrap_180(b - a - by_deg);
                assert!(off.abs() < 0.15, "{seed} {by_deg} {compass}: {off}");
                let wider = b_se / a_se;
                assert!(
                    (0.95..1.05).contains(&wider),
                    "{seed} {by_deg} {compass}: {wider}"
                );
            }
        }
    }
}

#[test]
fn least_squares_and_the_published_fit_find_a_turned_compass_too() {
    let voyage = sail(9200, Variety::Rich, 20.0, &Faults::USUAL);
    for (fit, off_deg) in [
        (
            fit_ols as fn(&[Observation]) -> Result<Model, FitError>,
            1e-6,
        ),
        (fit_paper, 0.15),
    ] {
        let straight = fit(&voyage.observations).unwrap();
        for by_deg in [10.0, -30.0, 90.0, 180.0] {
            let model = fit(&turned(&voyage.observations, by_deg)).unwrap();
            model.check().unwrap();
            let Truth { h_nt, z_nt, .. } = voyage.truth;
            for compass in headings() {
                let (a, a_se) = predicted(&straight, compass, h_nt, z_nt);
                let (b, b_se) = predicted(&model, compass - by_deg, h_nt, z_nt);
                let off = wrap_180(b - a - by_deg);
                assert!(off.abs() < off_deg, "{by_deg} {compass}: {off}");
                assert!((b_se / a_se - 1.0).abs() < 0.05, "{by_deg} {compass}");
            }
        }
    }
}

#[test]
fn wild_readings_do_not_hide_the_zero() {
    let voyage = sail(9300, Variety::Medium, 20.0, &Faults::USUAL);
    for by_deg in [0.0, 30.0, 180.0] {
        let sound = turned(&voyage.observations, by_deg);
        let mut disturbed = sound.clone();
        for o in disturbed.iter_mut().step_by(5) {
            o.deviation = Deviation::new(o.deviation.degrees_east() + 70.0).unwrap();
        }
        let (a, b) = (robust(&sound).unwrap(), robust(&disturbed).unwrap());
        let Truth { h_nt, z_nt, .. } = voyage.truth;
        for compass in headings() {
            let before = predicted(&a, compass, h_nt, z_nt).0;
            let after = predicted(&b, compass, h_nt, z_nt).0;
            assert!(wrap_180(after - before).abs() < 0.4, "{by_deg} {compass}");
        }
    }
}
