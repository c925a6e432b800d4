//! Ships and berths for tests of the planner.

mod card_check;
mod corrector_scale;
mod field_drift;
mod headings_at_sea;
mod optimal_plans;
mod paper;
mod refusals;
mod steps;
mod vertical_check;

use super::state::MagneticState;
use super::*;
use crate::berth::{Alignment, BerthReading, ReadingErrors};
use crate::binnacle::tests::class_a;
use crate::binnacle::{Axis, Binnacle, BinnacleForm, DesignForm, Setting};
use crate::corrector::effect;
use binnacle_compass::angle::MagneticHeading;
use binnacle_compass::model::{Identifiable, Model, Parameters, ReferenceGrade};
use binnacle_compass::ship::{EarthField, ShipMagnetism};

pub(crate) const BISCAY: EarthField = EarthField {
    h_nt: 24_000.0,
    z_nt: 38_500.0,
};

/// A ship without correctors, with its reading and model for the correctors of a binnacle.
pub(crate) struct Case {
    pub(crate) model: Model,
    pub(crate) reading: BerthReading,
    pub(crate) binnacle: Binnacle,
    pub(crate) waters: Vec<Water>,
    bare: ShipMagnetism,
}

pub(crate) fn bare() -> ShipMagnetism {
    ShipMagnetism {
        chi: [
            [-0.06, 0.002, -0.021],
            [0.003, -0.15, 0.002],
            [0.0, 0.0, -0.05],
        ],
        b_nt: [-900.0, -700.0, 1_500.0],
    }
}

fn small_covariance() -> binnacle_compass::model::Covariance {
    let mut covariance = [[0.0; 8]; 8];
    for (index, sd) in [60.0_f64, 1.5e-3, 50.0, 1.5e-3, 2e-3, 2e-3, 2e-3, 0.3]
        .into_iter()
        .enumerate()
    {
        covariance[index][index] = sd.powi(2);
    }
    covariance
}

impl Case {
    pub(crate) fn new(bare: ShipMagnetism, binnacle: Binnacle, magnetic_deg: f64) -> Case {
        let waters = vec![
            water("Biscay", BISCAY.h_nt, BISCAY.z_nt, 2.0),
            water("Cape Town", 15_500.0, -20_000.0, 1.0),
        ];
        let mean_h = 3.0 / (2.0 / BISCAY.h_nt + 1.0 / 15_500.0);
        let there = effect(&binnacle, &binnacle.setting);
        let seen = sum(&bare, &there.as_ship(mean_h));
        let model = Model {
            parameters_over_lambda: seen.parameters_over_lambda().unwrap(),
            constant_deg: 0.2,
            covariance: Some(small_covariance()),
            identifiable: None,
            rms_deg: None,
            samples_used: 100,
            samples_rejected: 0,
            quality: None,
            reference_grade: ReferenceGrade::Heading,
            mean_h_nt: None,
            needles: None,
        };
        // The magnetometer does not measure the needles.
        let there = sum(&bare, &there.as_ship(f64::INFINITY));
        let [x, y, _] = there.field_at_compass(BISCAY.in_ship_axes(magnetic_deg.to_radians()));
        let errors = ReadingErrors {
            field_sd_nt: 150.0,
            heading_sd_deg: 0.5,
            alignment_sd_deg: 0.3,
            tilt_sd_deg: 0.2,
        };
        let heading = MagneticHeading::new(magnetic_deg).unwrap();
        Case {
            model,
            reading: BerthReading::new(heading, [x, y], errors, Alignment::Keel).unwrap(),
            binnacle,
            waters,
            bare,
        }
    }

    pub(crate) fn adjustment(&self) -> Adjustment<'_> {
        Adjustment {
            model: &self.model,
            earth: BISCAY,
            reading: &self.reading,
            scale_sd: 0.003,
            compass_deg: None,
            vertical: None,
            binnacle: &self.binnacle,
            now: None,
            waters: &self.waters,
            circumstances: Circumstances::default(),
            limits: Limits {
                residual_deg: 10.0,
                band_deg: 5.0,
                ..Limits::default()
            },
        }
    }

    pub(crate) fn plan(&self) -> Outcome {
        plan(&self.adjustment()).unwrap()
    }
}

pub(crate) fn water(name: &str, h_nt: f64, z_nt: f64, weight: f64) -> Water {
    Water {
        name: name.to_owned(),
        h_nt,
        z_nt,
        weight,
    }
}

pub(crate) fn sum(one: &ShipMagnetism, other: &ShipMagnetism) -> ShipMagnetism {
    ShipMagnetism {
        chi: std::array::from_fn(|r| std::array::from_fn(|c| one.chi[r][c] + other.chi[r][c])),
        b_nt: std::array::from_fn(|axis| one.b_nt[axis] + other.b_nt[axis]),
    }
}

pub(crate) fn case(magnetic_deg: f64) -> Case {
    Case::new(bare(), class_a(), magnetic_deg)
}

/// A binnacle with so few settings that all can be tried.
pub(crate) fn little() -> Binnacle {
    let mut form: BinnacleForm = class_a().into();
    let mut design: DesignForm = form.design.into();
    for rack in [&mut design.fore_and_aft, &mut design.athwartship] {
        rack.holes.truncate(6);
        rack.at_once = 1;
        rack.magnets_each = 2;
    }
    let iron = design.quadrantal.as_mut().unwrap();
    iron.marks
        .retain(|mark| mark.mark_mm <= 280.0 || (mark.mark_mm - 320.0).abs() < 1e-9);
    iron.slews_deg = vec![0.0];
    form.inventory.flinders_pieces_mm = vec![225.0];
    form.inventory.quadrantal = vec!["7 inch".to_owned()];
    form.setting.athwartship[0].hole = 3;
    form.design = design.try_into().unwrap();
    Binnacle::try_from(form).unwrap()
}

#[test]
fn an_outcome_comes_back_from_json_as_it_went() {
    let outcome = case(60.0).plan();
    let text = serde_json::to_string(&outcome).unwrap();
    let again: Outcome = serde_json::from_str(&text).unwrap();
    assert_eq!(again.plans[0].setting, outcome.plans[0].setting);
    assert_eq!(again.plans[0].steps.len(), outcome.plans[0].steps.len());
}

#[test]
fn the_parameters_before_are_those_of_the_model() {
    // With nothing moved, the model after is the model, and no corrector has an error.
    let case = case(60.0);
    let adjustment = case.adjustment();
    let state = MagneticState::new(&adjustment).unwrap();
    let same = state.model_with(&case.binnacle.setting).unwrap();
    let (old, new): (Parameters, Parameters) = (
        case.model.parameters_over_lambda,
        same.parameters_over_lambda,
    );
    for (old, new) in old.to_array().iter().zip(new.to_array()) {
        assert!((old - new).abs() < 1e-9 * old.abs().max(1.0));
    }
    let (old, new) = (case.model.covariance.unwrap(), same.covariance.unwrap());
    for row in 0..8 {
        assert!((old[row][row] - new[row][row]).abs() < 1e-9 * old[row][row]);
    }
}
