//! For any observations a fit ends in a finite model or a named refusal.

use binnacle_analysis::advice::{Question, advise};
use binnacle_analysis::fit::{Observation, RobustOptions, fit_ols, fit_paper, fit_robust};
use binnacle_compass::angle::{CompassHeading, Deviation, Variation};
use binnacle_compass::coverage::coverage;
use binnacle_compass::model::Model;
use binnacle_compass::position::Position;
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use proptest::prelude::*;

/// Any observation that the types allow, wild ones more often than at sea.
fn observation() -> impl Strategy<Value = Observation> {
    let when = prop_oneof![
        Just(None),
        (1_700_000_000_i64..1_710_000_000).prop_map(Some),
        (-62_000_000_000_i64..250_000_000_000).prop_map(Some),
    ];
    let place = proptest::option::of((-90.0..=90.0_f64, -180.0..=180.0_f64));
    let field = prop_oneof![
        (10_000.0..40_000.0_f64, -60_000.0..60_000.0_f64),
        (1e-3..1e6_f64, -1e6..1e6_f64),
    ];
    let deviation = prop_oneof![-20.0..20.0_f64, -180.0..180.0_f64];
    let rest = (
        0.0..=1.0_f64,
        proptest::option::of(0.0..40.0_f64),
        any::<u16>(),
        0.0..3.0_f64,
        proptest::option::of(-180.0..=180.0_f64),
        proptest::option::of(0.0..=1e300_f64),
    );
    (when, place, 0.0..360.0_f64, deviation, field, rest).prop_map(
        |(when, place, compass, deviation, (h_nt, z_nt), rest)| Observation {
            time: when.and_then(|s| Timestamp::from_micros(s * 1_000_000).ok()),
            position: place.and_then(|(lat, lon)| Position::new(lat, lon).ok()),
            compass: CompassHeading::new(compass).expect("finite"),
            deviation: Deviation::new(deviation).expect("finite"),
            variation: Variation::ZERO,
            h_nt,
            z_nt,
            gyro_share: rest.0,
            gyro_less_satellite_deg: rest.4,
            sog_kn: rest.1,
            windows: rest.2,
            spread_deg: rest.5,
            weight: rest.3,
        },
    )
}

fn is_sound(model: &Model) -> bool {
    let covariance = model.covariance.expect("a fit has one");
    let numbers = model.parameters_over_lambda.to_array();
    numbers
        .iter()
        .chain(covariance.as_flattened())
        .all(|x| x.is_finite())
        && model.constant_deg.is_finite()
        && model.rms_deg.is_some_and(f64::is_finite)
        && (0..7).all(|j| covariance[j][j] >= 0.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_robust_fit_of_anything_is_finite_or_refused(
        observations in proptest::collection::vec(observation(), 0..150)
    ) {
        if let Ok(fit) = fit_robust(&observations, &RobustOptions::default()) {
            prop_assert!(is_sound(&fit.model), "{:?}", fit.model);
            prop_assert_eq!(fit.rows.len(), observations.len());
            let seen = observations.iter().map(|o| (o.compass, o.h_nt, o.z_nt));
            let advice = advise(&Question {
                model: &fit.model,
                noise: &fit.noise,
                reference_constant_sd_deg: 0.5,
                gyro_share: observations[0].gyro_share,
                here: EarthField {
                    h_nt: observations[0].h_nt,
                    z_nt: observations[0].z_nt,
                },
                elsewhere: &[],
                coverage: &coverage(seen),
            });
            if let Ok(next) = advice {
                let elsewhere = next.elsewhere.map_or(0.0, |advice| advice.band.worst_deg);
                let bands = [next.here.band.rms_deg, next.here.band.worst_deg, elsewhere];
                prop_assert!(bands.iter().all(|band| (0.0..=180.0).contains(band)), "{:?}", bands);
            }
        }
    }

    #[test]
    fn the_papers_fit_of_anything_is_finite_or_refused(
        observations in proptest::collection::vec(observation(), 0..60)
    ) {
        if let Ok(model) = fit_paper(&observations) {
            prop_assert!(is_sound(&model), "{:?}", model);
        }
    }

    #[test]
    fn ordinary_least_squares_of_anything_is_finite_or_refused(
        observations in proptest::collection::vec(observation(), 0..60)
    ) {
        if let Ok(model) = fit_ols(&observations) {
            prop_assert!(is_sound(&model), "{:?}", model);
            prop_assert_eq!(model.samples_used + model.samples_rejected, observations.len() as u64);
        }
    }
}
