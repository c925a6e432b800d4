//! The corrected heading: the raw compass with the model's deviation and the
//! field's variation, and what is known of its error.
//!
//! Nothing is made up: what cannot be told is absent, with the reason in words.

use crate::alert::Aboard;
use crate::weak_field::LEAST_H_NT;
use binnacle_magnetics::angle::{
    CompassHeading, Deviation, MagneticHeading, TrueHeading, Variation,
};
use binnacle_magnetics::field::{FieldModel, field};
use binnacle_magnetics::position::Position;
use binnacle_magnetics::ship::EarthField;
use binnacle_magnetics::time::Timestamp;
use binnacle_wire::messages::{CardWithdrawn, ModelDownlink};
use serde::{Deserialize, Serialize};

/// What the ship says that the correction needs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ingredients<'a> {
    /// The raw compass, unless it has fallen silent.
    pub(crate) compass: Option<CompassHeading>,
    /// Where the ship is, unless that is old.
    pub(crate) position: Option<Position>,
    /// The ship's time.
    pub(crate) time: Option<Timestamp>,
    /// The last model from shore.
    pub(crate) model: Option<&'a ModelDownlink>,
    /// Why that model holds no more; the shore has no other one yet.
    pub(crate) withdrawn: Option<&'a CardWithdrawn>,
    /// The ship's own alert, once there was one.
    pub(crate) alert: Option<&'a Aboard>,
    /// Whether the heading before this one was known too badly to be given out.
    pub(crate) withheld: bool,
}

/// One heading in three ways, as far as they can be told.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Corrected {
    /// The raw reading.
    pub(crate) compass_deg: Option<CompassHeading>,
    /// The model's deviation on this heading, here and now.
    pub(crate) deviation_deg: Option<Deviation>,
    /// The deviation's standard error.
    pub(crate) standard_error_deg: Option<f64>,
    /// 95 % of the errors are expected within this, either way.
    pub(crate) band95_deg: Option<f64>,
    /// The field's, not the receiver's.
    pub(crate) variation_deg: Option<Variation>,
    /// Compass with deviation.
    pub(crate) magnetic_deg: Option<MagneticHeading>,
    /// Magnetic with variation.
    pub(crate) true_deg: Option<TrueHeading>,
    /// Why something is missing.
    pub(crate) problem: Option<String>,
}

/// A row of the deviation card.
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

/// A heading that may be off by more than this, one time in twenty, is none to steer by:
/// nobody sees the band on an autopilot.
const WIDEST_BAND_DEG: f64 = 10.0;
/// One that was withheld is given out again at this: it does not come and go as she yaws.
const WIDEST_BAND_AGAIN_DEG: f64 = 9.0;

/// Corrects the compass as far as the ingredients go, and as far as it can be steered by.
pub(crate) fn correct(from: Ingredients<'_>) -> Corrected {
    let mut corrected = foretell(from);
    let widest_deg = if from.withheld {
        WIDEST_BAND_AGAIN_DEG
    } else {
        WIDEST_BAND_DEG
    };
    let is_wide = |band_deg: &f64| *band_deg > widest_deg;
    if let Some(band_deg) = corrected.band95_deg.filter(is_wide) {
        (corrected.magnetic_deg, corrected.true_deg) = (None, None);
        corrected.problem = Some(format!(
            "the deviation here is known to ±{band_deg:.0}° only"
        ));
    }
    corrected
}

impl Corrected {
    /// Whether it is known, but too badly to be steered by.
    pub(crate) fn is_withheld(&self) -> bool {
        self.band95_deg.is_some() && self.true_deg.is_none()
    }
}

/// Corrects the compass as far as the ingredients go, however little is known.
pub(crate) fn foretell(from: Ingredients<'_>) -> Corrected {
    let mut corrected = Corrected {
        compass_deg: from.compass,
        ..Corrected::default()
    };
    if let Err(problem) = fill(&mut corrected, from) {
        corrected.problem = Some(problem);
    }
    corrected
}

fn fill(corrected: &mut Corrected, from: Ingredients<'_>) -> Result<(), String> {
    let (earth, variation) = earth_at(from)?;
    corrected.variation_deg = Some(variation);
    if earth.h_nt < LEAST_H_NT {
        return Err("the field is too weak for a magnetic compass".to_owned());
    }
    let compass = from.compass.ok_or("the compass is silent")?;
    let model = from.model.ok_or("there is no model yet")?;
    // Better no heading than one by magnetism that the ship no longer has.
    if let Some(withdrawn) = from.withdrawn {
        return Err(withdrawn.to_string());
    }
    if from.alert.is_some_and(Aboard::is_of_the_compass) {
        return Err("the alert says not to steer by it".to_owned());
    }
    let foretold = model
        .model
        .deviation(compass, earth)
        .map_err(|e| e.to_string())?;
    let magnetic = compass + foretold.deviation;
    corrected.deviation_deg = Some(foretold.deviation);
    corrected.standard_error_deg = foretold.standard_error_deg;
    corrected.band95_deg = foretold.band95_deg;
    corrected.magnetic_deg = Some(magnetic);
    corrected.true_deg = Some(magnetic + variation);
    Ok(())
}

/// The card at the ship's place: every 15°, or nothing.
pub(crate) fn card(from: Ingredients<'_>) -> Vec<CardRow> {
    let (Ok((earth, _)), Some(model)) = (earth_at(from), from.model) else {
        return Vec::new();
    };
    if earth.h_nt < LEAST_H_NT || from.withdrawn.is_some() {
        return Vec::new();
    }
    let row = |step: u32| {
        let compass = CompassHeading::new(f64::from(step * 15))?;
        let foretold = model.model.deviation(compass, earth).ok()?;
        Some(CardRow {
            compass_deg: compass.degrees(),
            deviation_deg: foretold.deviation,
            band95_deg: foretold.band95_deg,
        })
    };
    (0..24).filter_map(row).collect()
}

fn earth_at(from: Ingredients<'_>) -> Result<(EarthField, Variation), String> {
    let position = from.position.ok_or("the position is not known")?;
    let time = from.time.ok_or("the time is not known")?;
    let field = field(FieldModel::Igrf14, position, 0.0, time).map_err(|e| e.to_string())?;
    Ok((field.for_ship(), field.declination()))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use binnacle_magnetics::model::{Model, Parameters};
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
            },
        }
    }

    fn ingredients(model: Option<&ModelDownlink>) -> Ingredients<'_> {
        Ingredients {
            compass: CompassHeading::new(90.0),
            position: Position::new(43.3, -3.0).ok(),
            time: Timestamp::parse("2026-11-21T07:00:00Z").ok(),
            model,
            withdrawn: None,
            alert: None,
            withheld: false,
        }
    }

    #[test]
    fn a_fore_and_aft_magnet_deviates_east_on_east() {
        // sin(deviation) = bx/H on compass east: 2400 nT against some 24 000 nT.
        let model = model(2_400.0, None);
        let corrected = correct(ingredients(Some(&model)));
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
            let corrected = correct(Ingredients {
                withheld,
                ..ingredients(Some(&model))
            });
            assert_eq!(corrected.is_withheld(), corrected.true_deg.is_none());
            (corrected.true_deg.is_some(), corrected.problem)
        };
        assert_eq!(known(5.0, false), (true, None));
        // Once withheld it must be known somewhat better.
        assert!(!known(5.0, true).0);
        assert_eq!(known(4.5, true), (true, None));
        let (is_given, problem) = known(5.2, false);
        assert!(!is_given);
        assert_eq!(
            problem.as_deref(),
            Some("the deviation here is known to ±10° only")
        );
    }

    #[test]
    fn the_band_follows_from_the_covariance() {
        let model = model(0.0, Some(0.25));
        let corrected = correct(ingredients(Some(&model)));
        assert!((corrected.standard_error_deg.unwrap() - 0.5).abs() < 1e-12);
        assert!((corrected.band95_deg.unwrap() - 0.98).abs() < 1e-3);
        let card = card(ingredients(Some(&model)));
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
        let from = Ingredients {
            withdrawn: Some(&withdrawn),
            ..ingredients(Some(&model))
        };
        let corrected = correct(from);
        assert!(corrected.compass_deg.is_some() && corrected.variation_deg.is_some());
        assert_eq!((corrected.deviation_deg, corrected.true_deg), (None, None));
        assert_eq!(
            corrected.problem.as_deref(),
            Some("the card has not held since 2026-11-21T06:00:00Z (corrector change)")
        );
        assert!(card(from).is_empty());
    }

    #[test]
    fn an_alert_of_the_compass_withholds_its_heading_and_one_of_the_gyro_does_not() {
        let model = model(2_400.0, None);
        let at = Timestamp::parse("2026-11-21T06:00:00Z").unwrap();
        let of = |state, gyro, satellite| {
            let alert = Aboard {
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
                followed: false,
                parted: 1,
                raised_by_deg: None,
                is_doubted: false,
            };
            correct(Ingredients {
                alert: Some(&alert),
                ..ingredients(Some(&model))
            })
        };
        let open = ShipAlertState::Open;
        for suspected in [of(open, Some(9.0), Some(9.2)), of(open, Some(9.0), None)] {
            assert!(suspected.compass_deg.is_some());
            assert_eq!((suspected.deviation_deg, suspected.true_deg), (None, None));
            let problem = suspected.problem.unwrap();
            assert!(problem.contains("not to steer by it"), "{problem}");
        }
        let of_the_gyro = of(open, Some(9.0), Some(0.2));
        let over = of(ShipAlertState::Agree, Some(9.0), Some(9.2));
        assert!(of_the_gyro.true_deg.is_some() && over.true_deg.is_some());
    }

    #[test]
    fn nothing_is_corrected_beside_a_magnetic_pole() {
        let model = model(0.0, None);
        let from = Ingredients {
            position: Position::new(-64.0, 136.0).ok(),
            ..ingredients(Some(&model))
        };
        let corrected = correct(from);
        assert!(corrected.compass_deg.is_some() && corrected.true_deg.is_none());
        assert!(corrected.problem.unwrap().contains("too weak"));
        assert!(card(from).is_empty());
    }

    #[test]
    fn what_is_missing_is_named_and_the_rest_is_given() {
        let no_model = correct(ingredients(None));
        assert!(no_model.variation_deg.is_some() && no_model.true_deg.is_none());
        assert_eq!(no_model.problem.as_deref(), Some("there is no model yet"));
        let model = model(0.0, None);
        let silent = correct(Ingredients {
            compass: None,
            ..ingredients(Some(&model))
        });
        assert_eq!(silent.problem.as_deref(), Some("the compass is silent"));
        let lost = correct(Ingredients {
            position: None,
            ..ingredients(Some(&model))
        });
        assert!(lost.compass_deg.is_some() && lost.deviation_deg.is_none());
        let ambiguous = self::model(1e6, None);
        assert!(correct(ingredients(Some(&ambiguous))).problem.is_some());
        assert!(card(ingredients(Some(&ambiguous))).is_empty());
    }
}
