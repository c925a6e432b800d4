//! Corrected heading: the raw compass with the model's deviation and the field's variation, and its
//! uncertainty.
//!
//! Nothing is invented: a value that cannot be computed is absent, with the reason in words.

use crate::weak_field::MIN_H_NT;
use binnacle_compass::angle::{
    CompassHeading, Deviation, MagneticHeading, TrueHeading, Variation, wrap_180,
};
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use binnacle_instruments::{ReckonedPlace, offset};
use binnacle_wire::messages::{CardWithdrawn, ModelDownlink};
use serde::{Deserialize, Serialize};

/// Inputs of the correction.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CorrectionInputs<'a> {
    /// Raw compass heading, unless the compass is silent.
    pub(crate) compass: Option<CompassHeading>,
    /// Set while two sensors that read differently send as the compass.
    pub(crate) compass_is_mixed: bool,
    /// Place of the vessel, by dead reckoning from the last trusted fix.
    pub(crate) place: Option<ReckonedPlace>,
    /// GNSS time.
    pub(crate) time: Option<Timestamp>,
    /// Last model from the server.
    pub(crate) model: Option<&'a ModelDownlink>,
    /// Reason why that model is no longer valid, while the server has no other one.
    pub(crate) withdrawn: Option<&'a CardWithdrawn>,
    /// Set while the agent's open alert suspects the compass.
    pub(crate) compass_suspected: bool,
    /// Set if the previous heading was withheld because its band was too wide.
    pub(crate) withheld: bool,
}

/// Compass, magnetic and true heading, as far as they are known.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct CorrectedHeading {
    /// Raw reading.
    pub(crate) compass_deg: Option<CompassHeading>,
    /// Deviation of the model on this heading, here and now.
    pub(crate) deviation_deg: Option<Deviation>,
    /// Standard error of the deviation.
    pub(crate) standard_error_deg: Option<f64>,
    /// Half-width of the 95 % confidence band.
    pub(crate) band95_deg: Option<f64>,
    /// Variation of the field, not of the receiver.
    pub(crate) variation_deg: Option<Variation>,
    /// Compass heading plus deviation.
    pub(crate) magnetic_deg: Option<MagneticHeading>,
    /// Magnetic heading plus variation.
    pub(crate) true_deg: Option<TrueHeading>,
    /// Reason for a missing value.
    pub(crate) problem: Option<String>,
}

/// Row of the deviation card.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(
    clippy::struct_field_names,
    reason = "names carry their units, in JSON too"
)]
pub(crate) struct CardRow {
    pub(crate) compass_deg: f64,
    pub(crate) deviation_deg: Deviation,
    pub(crate) band95_deg: Option<f64>,
}

/// Confidence band above which the heading is withheld: an autopilot does not show the band.
const MAX_BAND_DEG: f64 = 10.0;
/// Radius of the place below which the field is that of its middle, nautical miles.
const NEAR_NM: f64 = 1.0;
/// Half-width of a 95 % band in standard errors.
const BAND_SIGMAS: f64 = 1.96;
/// Confidence band at which a withheld heading is released, so that it does not flicker as the
/// vessel yaws.
const RELEASE_BAND_DEG: f64 = 9.0;

/// Corrects the compass as far as the inputs allow, and withholds a heading that is too uncertain
/// to steer by.
pub(crate) fn correct(inputs: CorrectionInputs<'_>) -> CorrectedHeading {
    let mut corrected = predict(inputs);
    let max_band_deg = if inputs.withheld {
        RELEASE_BAND_DEG
    } else {
        MAX_BAND_DEG
    };
    let is_wide = |band_deg: &f64| *band_deg > max_band_deg;
    if let Some(band_deg) = corrected.band95_deg.filter(is_wide) {
        (corrected.magnetic_deg, corrected.true_deg) = (None, None);
        corrected.problem = Some(format!(
            "the deviation here is known only to ±{band_deg:.0}°"
        ));
    }
    corrected
}

impl CorrectedHeading {
    /// Returns whether the heading is known, but too uncertain to steer by.
    pub(crate) fn is_withheld(&self) -> bool {
        self.band95_deg.is_some() && self.true_deg.is_none()
    }
}

/// Corrects the compass as far as the inputs allow, however wide the band is.
pub(crate) fn predict(inputs: CorrectionInputs<'_>) -> CorrectedHeading {
    let mut corrected = CorrectedHeading {
        compass_deg: inputs.compass,
        ..CorrectedHeading::default()
    };
    if let Err(problem) = apply_model(&mut corrected, inputs) {
        corrected.problem = Some(problem);
    }
    corrected
}

fn apply_model(
    corrected: &mut CorrectedHeading,
    inputs: CorrectionInputs<'_>,
) -> Result<(), String> {
    let (earth, variation) = field_at(inputs)?;
    corrected.variation_deg = Some(variation);
    if earth.h_nt < MIN_H_NT {
        return Err("the field is too weak for a magnetic compass".to_owned());
    }
    if inputs.compass_is_mixed {
        return Err("two sensors that read differently send as the compass".to_owned());
    }
    let compass = inputs.compass.ok_or("the compass is silent")?;
    let model = inputs.model.ok_or("there is no model yet")?;
    // No heading is better than one from magnetism that the vessel no longer has.
    if let Some(withdrawn) = inputs.withdrawn {
        return Err(withdrawn.to_string());
    }
    if inputs.compass_suspected {
        return Err("the open alert suspects the compass: do not steer by it".to_owned());
    }
    let predicted = model
        .model
        .deviation(compass, earth)
        .map_err(|e| e.to_string())?;
    let magnetic = compass + predicted.deviation;
    corrected.deviation_deg = Some(predicted.deviation);
    let by_place_deg = error_by_place_deg(inputs, model, compass, predicted.deviation);
    corrected.standard_error_deg = predicted
        .standard_error_deg
        .map(|deg| deg.hypot(by_place_deg / BAND_SIGMAS));
    // A model without errors of its own has at least that of the place.
    let by_place = (by_place_deg > 0.0).then_some(by_place_deg);
    corrected.band95_deg = predicted
        .band95_deg
        .map(|deg| deg.hypot(by_place_deg))
        .or(by_place);
    corrected.magnetic_deg = Some(magnetic);
    corrected.true_deg = Some(magnetic + variation);
    Ok(())
}

/// Returns the error of the true heading that the uncertain place makes, degrees: the greatest of
/// four places at its limit.
fn error_by_place_deg(
    inputs: CorrectionInputs<'_>,
    model: &ModelDownlink,
    compass: CompassHeading,
    deviation: Deviation,
) -> f64 {
    let Some(place) = inputs.place.filter(|place| place.radius_nm > NEAR_NM) else {
        return 0.0;
    };
    let Ok((_, variation)) = field_at(inputs) else {
        return 0.0;
    };
    let sum_deg = deviation.degrees_east() + variation.degrees_east();
    let r = place.radius_nm;
    let errors = [(r, 0.0), (-r, 0.0), (0.0, r), (0.0, -r)].map(|(north_nm, east_nm)| {
        let there = CorrectionInputs {
            place: Some(ReckonedPlace::exactly(offset(
                place.position,
                north_nm,
                east_nm,
            ))),
            ..inputs
        };
        let Ok((earth, variation)) = field_at(there) else {
            return f64::INFINITY;
        };
        match model.model.deviation(compass, earth) {
            Ok(there) => {
                let there_deg = there.deviation.degrees_east() + variation.degrees_east();
                wrap_180(there_deg - sum_deg).abs()
            }
            Err(_) => f64::INFINITY,
        }
    });
    errors.into_iter().fold(0.0, f64::max)
}

/// Returns the deviation card at the vessel's position: every 15°, or no rows.
pub(crate) fn card(inputs: CorrectionInputs<'_>) -> Vec<CardRow> {
    let (Ok((earth, _)), Some(model)) = (field_at(inputs), inputs.model) else {
        return Vec::new();
    };
    if earth.h_nt < MIN_H_NT || inputs.withdrawn.is_some() {
        return Vec::new();
    }
    let row = |step: u32| {
        let compass = CompassHeading::new(f64::from(step * 15))?;
        let predicted = model.model.deviation(compass, earth).ok()?;
        Some(CardRow {
            compass_deg: compass.degrees(),
            deviation_deg: predicted.deviation,
            band95_deg: predicted.band95_deg,
        })
    };
    (0..24).filter_map(row).collect()
}

fn field_at(inputs: CorrectionInputs<'_>) -> Result<(EarthField, Variation), String> {
    let position = inputs.place.ok_or("the position is unknown")?.position;
    let time = inputs.time.ok_or("the time is unknown")?;
    let field = field(FieldModel::Igrf14, position, 0.0, time).map_err(|e| e.to_string())?;
    Ok((field.for_ship(), field.declination()))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::alert::AlertRecord;
    use binnacle_compass::model::{Model, Parameters, ReferenceGrade};
    use binnacle_compass::position::Position;
    use binnacle_wire::alert::{ShipAlert, ShipAlertState};

    pub(crate) fn model(bx_nt: f64, constant_variance: Option<f64>) -> ModelDownlink {
        let covariance = constant_variance.map(|variance| {
            let mut covariance = [[0.0; 8]; 8];
            covariance[7][7] = variance;
            covariance
        });
        ModelDownlink {
            id: uuid::Uuid::from_u128(1),
            version: 1,
            data_until: Timestamp::parse("2026-11-20T00:00:00Z").unwrap(),
            replaces: None,
            model: Model {
                parameters_over_lambda: Parameters {
                    bx_nt,
                    chi13: 0.0,
                    by_nt: 0.0,
                    chi23: 0.0,
                    chi11_minus_chi22: 0.0,
                    chi12: 0.0,
                    chi21: 0.0,
                },
                constant_deg: 0.0,
                covariance,
                identifiable: None,
                rms_deg: None,
                samples_used: 0,
                samples_rejected: 0,
                quality: None,
                reference_grade: ReferenceGrade::Heading,
                mean_h_nt: None,
                needles: None,
            },
        }
    }

    fn place(lat_deg: f64, lon_deg: f64) -> Option<ReckonedPlace> {
        let position = Position::new(lat_deg, lon_deg).ok()?;
        Some(ReckonedPlace::exactly(position))
    }

    fn inputs(model: Option<&ModelDownlink>) -> CorrectionInputs<'_> {
        CorrectionInputs {
            compass: CompassHeading::new(90.0),
            compass_is_mixed: false,
            place: place(43.3, -3.0),
            time: Timestamp::parse("2026-11-21T07:00:00Z").ok(),
            model,
            withdrawn: None,
            compass_suspected: false,
            withheld: false,
        }
    }

    #[test]
    fn a_fore_and_aft_magnet_deviates_east_on_east() {
        // sin(deviation) = bx/H on compass east: 2400 nT against some 24 000 nT.
        let model = model(2_400.0, None);
        let corrected = correct(inputs(Some(&model)));
        let deviation = corrected.deviation_deg.unwrap();
        assert!(
            (4.0..8.0).contains(&deviation.degrees_east()),
            "{deviation}"
        );
        let magnetic = corrected.compass_deg.unwrap() + deviation;
        assert_eq!(corrected.magnetic_deg, Some(magnetic));
        assert_eq!(
            corrected.true_deg,
            Some(magnetic + corrected.variation_deg.unwrap())
        );
        assert_eq!((corrected.band95_deg, corrected.problem), (None, None));
    }

    #[test]
    fn a_heading_known_to_no_better_than_ten_degrees_is_none_to_steer_by() {
        let known = |sd_deg: f64, withheld: bool| {
            let model = model(0.0, Some(sd_deg * sd_deg));
            let corrected = correct(CorrectionInputs {
                withheld,
                ..inputs(Some(&model))
            });
            assert_eq!(corrected.is_withheld(), corrected.true_deg.is_none());
            (corrected.true_deg.is_some(), corrected.problem)
        };
        assert_eq!(known(5.0, false), (true, None));
        // Once withheld, the band must be somewhat narrower.
        assert!(!known(5.0, true).0);
        assert_eq!(known(4.5, true), (true, None));
        let (is_given, problem) = known(5.2, false);
        assert!(!is_given);
        assert_eq!(
            problem.as_deref(),
            Some("the deviation here is known only to ±10°")
        );
    }

    #[test]
    fn the_band_grows_with_the_uncertainty_of_the_place() {
        let model = model(2_400.0, Some(0.25));
        let band = |radius_nm| {
            let place = place(43.3, -3.0).map(|place| ReckonedPlace { radius_nm, ..place });
            let inputs = CorrectionInputs {
                place,
                ..inputs(Some(&model))
            };
            correct(inputs).band95_deg.unwrap()
        };
        assert!((band(0.5) - 0.98).abs() < 1e-3);
        // Variation changes by about a degree in two hundred miles there.
        let (near, far) = (band(20.0), band(200.0));
        assert!(0.98 < near && near < 1.1, "{near}");
        assert!((1.2..4.0).contains(&far), "{far}");
    }

    #[test]
    fn a_place_that_is_lost_ends_the_heading_of_a_model_without_errors_too() {
        let model = model(2_400.0, None);
        let corrected = |radius_nm| {
            let place = place(43.3, -3.0).map(|place| ReckonedPlace { radius_nm, ..place });
            correct(CorrectionInputs {
                place,
                ..inputs(Some(&model))
            })
        };
        assert!(corrected(0.5).true_deg.is_some() && corrected(0.5).band95_deg.is_none());
        assert!(corrected(100.0).band95_deg.is_some());
        assert!(corrected(3_000.0).is_withheld());
    }

    #[test]
    fn the_band_follows_from_the_covariance() {
        let model = model(0.0, Some(0.25));
        let corrected = correct(inputs(Some(&model)));
        assert!((corrected.standard_error_deg.unwrap() - 0.5).abs() < 1e-12);
        assert!((corrected.band95_deg.unwrap() - 0.98).abs() < 1e-3);
        let card = card(inputs(Some(&model)));
        assert_eq!(card.len(), 24);
        assert!(card.iter().all(|row| row.band95_deg.is_some()));
    }

    #[test]
    fn a_card_that_was_withdrawn_corrects_nothing_and_says_why() {
        let model = model(2_400.0, None);
        let withdrawn = CardWithdrawn {
            since: Timestamp::parse("2026-11-21T06:00:00Z").unwrap(),
            reason: "corrector_change".to_owned(),
        };
        let inputs = CorrectionInputs {
            withdrawn: Some(&withdrawn),
            ..inputs(Some(&model))
        };
        let corrected = correct(inputs);
        assert!(corrected.compass_deg.is_some() && corrected.variation_deg.is_some());
        assert_eq!((corrected.deviation_deg, corrected.true_deg), (None, None));
        assert_eq!(
            corrected.problem.as_deref(),
            Some("the card has not held since 2026-11-21T06:00:00Z (corrector change)")
        );
        assert!(card(inputs).is_empty());
    }

    #[test]
    fn an_alert_of_the_compass_withholds_its_heading_and_one_of_the_gyro_does_not() {
        let model = model(2_400.0, None);
        let at = Timestamp::parse("2026-11-21T06:00:00Z").unwrap();
        let of = |state, gyro, satellite| {
            let alert = AlertRecord {
                alert: ShipAlert {
                    id: uuid::Uuid::from_u128(1),
                    revision: 1,
                    state,
                    since: at,
                    at,
                    gyro_departure_deg: gyro,
                    satellite_departure_deg: satellite,
                    limit_deg: 4.0,
                    model_version: 1,
                },
                acknowledged: true,
                followed_up: false,
                departed_sectors: 1,
                raised_limit_deg: None,
                clearance_revoked: false,
            };
            correct(CorrectionInputs {
                compass_suspected: alert.suspects_compass(),
                ..inputs(Some(&model))
            })
        };
        let open = ShipAlertState::Open;
        for suspected in [of(open, Some(9.0), Some(9.2)), of(open, Some(9.0), None)] {
            assert!(suspected.compass_deg.is_some());
            assert_eq!((suspected.deviation_deg, suspected.true_deg), (None, None));
            let problem = suspected.problem.unwrap();
            assert!(problem.contains("do not steer by it"), "{problem}");
        }
        let of_the_gyro = of(open, Some(9.0), Some(0.2));
        let over = of(ShipAlertState::Agree, Some(9.0), Some(9.2));
        assert!(of_the_gyro.true_deg.is_some() && over.true_deg.is_some());
    }

    #[test]
    fn nothing_is_corrected_beside_a_magnetic_pole() {
        let model = model(0.0, None);
        let inputs = CorrectionInputs {
            place: place(-64.0, 136.0),
            ..inputs(Some(&model))
        };
        let corrected = correct(inputs);
        assert!(corrected.compass_deg.is_some() && corrected.true_deg.is_none());
        assert!(corrected.problem.unwrap().contains("too weak"));
        assert!(card(inputs).is_empty());
    }

    #[test]
    fn what_is_missing_is_named_and_the_rest_is_given() {
        let no_model = correct(inputs(None));
        assert!(no_model.variation_deg.is_some() && no_model.true_deg.is_none());
        assert_eq!(no_model.problem.as_deref(), Some("there is no model yet"));
        let model = model(0.0, None);
        let silent = correct(CorrectionInputs {
            compass: None,
            ..inputs(Some(&model))
        });
        assert_eq!(silent.problem.as_deref(), Some("the compass is silent"));
        let lost = correct(CorrectionInputs {
            place: None,
            ..inputs(Some(&model))
        });
        assert!(lost.compass_deg.is_some() && lost.deviation_deg.is_none());
        let ambiguous = self::model(1e6, None);
        assert!(correct(inputs(Some(&ambiguous))).problem.is_some());
        assert!(card(inputs(Some(&ambiguous))).is_empty());
    }
}
