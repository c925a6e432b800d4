//! State of the ship's magnetism at the berth, and with any other setting.
//!
//! `base` is the ship without correctors: the measured ship less the effect of its setting
//! then. The needles' part of that effect is in the model as at the mean H of its samples.

use super::corrector_errors::setting_errors;
use super::field_drift::FieldDrift;
use crate::adjust::diagnosis::VerticalCheck;
use crate::adjust::inputs::{AdjustError, Adjustment, VerticalReading};
use crate::adjust::needle_part::{at_lambda, lambda_without_needles};
use crate::berth::{BerthEstimate, JointCovariance, TwoHeadings, lambda_by_two_headings};
use crate::binnacle::{BarSetting, Binnacle, Setting, Soft};
use crate::corrector::{Effect, Iron, effect, needle_induction};
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::model::{Covariance, Model, Parameters};
use binnacle_compass::ship::{PARAMETERS, ShipMagnetism};

const LAMBDA: usize = PARAMETERS + 1;

type JointRow = [f64; LAMBDA + 1];

pub(crate) struct MagneticState<'a> {
    pub(crate) binnacle: &'a Binnacle,
    model: &'a Model,
    pub(crate) estimate: BerthEstimate,
    joint: JointCovariance,
    pub(crate) drift: FieldDrift,
    /// λ by two headings, if a second one was read.
    pub(crate) two_headings: Option<TwoHeadings>,
    lambda: f64,
    base: ShipMagnetism,
    /// Effect of the correctors at the time of the reading.
    measured_effect: Effect,
    /// Horizontal field at which the needles' part was fitted, nT.
    pub(super) reference_h_nt: f64,
    pub(crate) may_move_bar: bool,
    /// Vertical field at the berth, if measured plausibly.
    pub(crate) vertical: Option<VerticalReading>,
}

impl<'a> MagneticState<'a> {
    pub(crate) fn new(adjustment: &Adjustment<'a>) -> Result<MagneticState<'a>, AdjustError> {
        let binnacle = adjustment.binnacle;
        let measured_effect = effect(binnacle, &binnacle.setting);
        let model = adjustment.model;
        let reference_h_nt = model.reference_h_nt();
        let reference_h_nt = reference_h_nt.unwrap_or_else(|| harmonic_mean_h(adjustment));
        let p = &model.parameters_over_lambda;
        let (earth, reading) = (adjustment.earth, adjustment.reading);
        let mut estimate = lambda_without_needles(model, binnacle, reference_h_nt, earth, reading)?;
        let two_headings = match &adjustment.circumstances.shifted {
            Some(shifted) => {
                let usual = estimate.lambda.value;
                let without = at_lambda(model, binnacle, reference_h_nt, usual)?;
                let two = lambda_by_two_headings(&without, earth, [reading, shifted], usual)?;
                estimate.replace_lambda(&two);
                Some(two)
            }
            None => None,
        };
        let lambda = estimate.lambda.value;
        let mut joint = estimate.covariance.unwrap_or_default();
        joint[LAMBDA][LAMBDA] += (lambda * adjustment.scale_sd).powi(2);
        let drift = FieldDrift::new(adjustment, &estimate, joint[LAMBDA][LAMBDA]);
        drift.widen(&mut joint);
        let measured = ShipMagnetism::from_parameters(p, lambda);
        let base = minus(&measured, &measured_effect.as_ship(reference_h_nt));
        Ok(MagneticState {
            binnacle,
            model,
            estimate,
            joint,
            drift,
            two_headings,
            lambda,
            base,
            measured_effect,
            reference_h_nt,
            may_move_bar: model.identifiable.is_none_or(|known| known.chi13),
            vertical: adjustment
                .vertical
                .filter(|read| VerticalCheck::new(*read, adjustment.earth, binnacle).is_credible()),
        })
    }

    /// Returns the state as if λ were known exactly.
    pub(crate) fn with_exact_lambda(&self) -> MagneticState<'a> {
        let mut joint = self.joint;
        joint[LAMBDA] = [0.0; LAMBDA + 1];
        for row in &mut joint {
            row[LAMBDA] = 0.0;
        }
        MagneticState { joint, ..*self }
    }

    /// Returns the state with another λ, for the same headings at sea.
    pub(crate) fn with_lambda(&self, lambda: f64) -> MagneticState<'a> {
        let p = &self.model.parameters_over_lambda;
        let measured = ShipMagnetism::from_parameters(p, lambda);
        MagneticState {
            lambda,
            base: minus(
                &measured,
                &self.measured_effect.as_ship(self.reference_h_nt),
            ),
            ..*self
        }
    }

    pub(crate) fn constant_deg(&self) -> f64 {
        self.model.constant_deg
    }

    /// Returns the relative standard error of λ.
    pub(crate) fn lambda_sd_share(&self) -> f64 {
        self.joint[LAMBDA][LAMBDA].sqrt() / self.lambda
    }

    /// Returns the whole ship with correctors of this effect at a horizontal field H.
    pub(crate) fn with_effect(&self, effect: &Effect, h_nt: f64) -> ShipMagnetism {
        let chi = effect.chi_at(h_nt);
        ShipMagnetism {
            chi: std::array::from_fn(|row| {
                std::array::from_fn(|column| self.base.chi[row][column] + chi[row][column])
            }),
            b_nt: std::array::from_fn(|axis| self.base.b_nt[axis] + effect.b_nt[axis]),
        }
    }

    /// Returns the field induced across the card per unit of vertical field with a bar: the
    /// magnitude of χ13 and χ23 together.
    pub(crate) fn left_to_induction(&self, bar: Option<&BarSetting>) -> f64 {
        let soft = Soft {
            quadrantal: None,
            flinders: bar.cloned(),
        };
        let bar = Iron::new(self.binnacle, &soft).effect(0.0);
        let left = |row: usize| self.base.chi[row][2] + bar.chi[row][2];
        left(0).hypot(left(1))
    }

    pub(crate) fn lambda_with(&self, setting: &Setting) -> f64 {
        let effect = effect(self.binnacle, setting);
        self.with_effect(&effect, self.reference_h_nt).lambda()
    }

    /// Returns the change of the vertical field per unit of the earth's vertical field.
    pub(crate) fn chi33_change(&self, effect: &Effect) -> f64 {
        effect.chi[2][2] - self.measured_effect.chi[2][2]
    }

    /// Returns the change of the permanent vertical field, nT.
    pub(crate) fn bz_change(&self, effect: &Effect) -> f64 {
        effect.b_nt[2] - self.measured_effect.b_nt[2]
    }

    /// Returns the model with a setting; its covariance includes the errors of the old
    /// model, of λ, and of every moved corrector (docs/science.md, eq. 24).
    pub(crate) fn model_with(&self, setting: &Setting) -> Result<Model, DeviationError> {
        let effect = effect(self.binnacle, setting);
        let ship = self.with_effect(&effect, self.reference_h_nt);
        let after = ship.parameters_over_lambda();
        let after = after.map_err(|_| DeviationError::NotFinite)?;
        let covariance = self
            .model
            .covariance
            .map(|_| self.covariance(setting, &after, &ship));
        Ok(Model {
            parameters_over_lambda: after,
            covariance,
            needles: needle_induction(&effect, ship.lambda(), self.reference_h_nt),
            ..self.model.clone()
        })
    }

    pub(super) fn covariance(
        &self,
        setting: &Setting,
        after: &Parameters,
        ship: &ShipMagnetism,
    ) -> Covariance {
        let after = after.to_array();
        let new_lambda = ship.lambda();
        let slopes = self.slopes(&after, new_lambda);
        let mut covariance = [[0.0; LAMBDA]; LAMBDA];
        for (row, by) in slopes.iter().enumerate() {
            for (column, with) in slopes.iter().enumerate() {
                covariance[row][column] = quadratic(&self.joint, by, with);
            }
        }
        for error in setting_errors(self.binnacle, setting) {
            let sensitivity = self.sensitivity(&error, &after, new_lambda);
            for (row, one) in sensitivity.iter().enumerate() {
                for (column, other) in sensitivity.iter().enumerate() {
                    covariance[row][column] += one * other;
                }
            }
        }
        covariance
    }

    /// Returns the slopes of the new model's eight unknowns by the nine measured ones.
    fn slopes(&self, after: &[f64; PARAMETERS], new_lambda: f64) -> [JointRow; LAMBDA] {
        let before = self.model.parameters_over_lambda.to_array();
        let mut slopes = [[0.0; LAMBDA + 1]; LAMBDA];
        for (index, row) in slopes.iter_mut().enumerate().take(PARAMETERS) {
            row[index] = self.lambda / new_lambda;
            row[LAMBDA] = (before[index] - after[index]) / new_lambda;
        }
        slopes[PARAMETERS][PARAMETERS] = 1.0;
        slopes
    }

    /// Returns the change of the eight unknowns by an additional effect.
    fn sensitivity(
        &self,
        effect: &Effect,
        after: &[f64; PARAMETERS],
        new_lambda: f64,
    ) -> [f64; LAMBDA] {
        let effect = effect.as_ship(self.reference_h_nt);
        let way = seven(&effect);
        let lambda = effect.lambda() - 1.0;
        std::array::from_fn(|i| match way.get(i) {
            Some(way) => (way - after[i] * lambda) / new_lambda,
            None => 0.0,
        })
    }

    /// Returns the ship's state with a setting, for later readings.
    pub(crate) fn with_setting(
        &self,
        setting: &Setting,
    ) -> Result<StateWithSetting<'_>, DeviationError> {
        let effect = effect(self.binnacle, setting);
        let ship = self.with_effect(&effect, self.reference_h_nt);
        let model = self.model_with(setting)?;
        let after = model.parameters_over_lambda.to_array();
        let slopes = self.slopes(&after, ship.lambda());
        Ok(StateWithSetting {
            state: self,
            setting: setting.clone(),
            effect,
            model,
            after,
            new_lambda: ship.lambda(),
            slopes,
        })
    }
}

/// State of the ship with a setting, before any later reading.
pub(crate) struct StateWithSetting<'c> {
    state: &'c MagneticState<'c>,
    pub(crate) setting: Setting,
    pub(crate) effect: Effect,
    pub(crate) model: Model,
    after: [f64; PARAMETERS],
    new_lambda: f64,
    slopes: [JointRow; LAMBDA],
}

impl StateWithSetting<'_> {
    /// Returns the change of the model's eight unknowns by an additional effect.
    pub(crate) fn sensitivity(&self, effect: &Effect) -> [f64; LAMBDA] {
        self.state.sensitivity(effect, &self.after, self.new_lambda)
    }

    /// Returns the slopes of the model's eight unknowns by the eight measured ones and,
    /// last, by λ.
    pub(crate) fn slopes(&self) -> &[JointRow; LAMBDA] {
        &self.slopes
    }
}

impl MagneticState<'_> {
    pub(crate) fn lambda(&self) -> f64 {
        self.lambda
    }

    /// Returns the covariance of the eight measured unknowns and, last, λ, including the
    /// magnetometer's scale.
    pub(crate) fn joint(&self) -> &JointCovariance {
        &self.joint
    }

    /// Returns the effect of the correctors at the time of the reading.
    pub(crate) fn measured_effect(&self) -> &Effect {
        &self.measured_effect
    }

    /// Returns the horizontal field at the card without bowl and needles, nT, with
    /// correctors of this effect, for an earth's field in ship axes.
    pub(crate) fn field(&self, effect: &Effect, earth: [f64; 3]) -> [f64; 2] {
        let [x, y, _] = self
            .with_effect(effect, f64::INFINITY)
            .field_at_compass(earth);
        [x, y]
    }
}

/// Returns the seven parameters of an effect, not over λ, in the order of the parameters.
fn seven(ship: &ShipMagnetism) -> [f64; PARAMETERS] {
    let chi = &ship.chi;
    [
        ship.b_nt[0],
        chi[0][2],
        ship.b_nt[1],
        chi[1][2],
        chi[0][0] - chi[1][1],
        chi[0][1],
        chi[1][0],
    ]
}

fn quadratic(joint: &JointCovariance, by: &[f64; 9], with: &[f64; 9]) -> f64 {
    let row = |row: &[f64; 9]| row.iter().zip(with).map(|(c, w)| c * w).sum::<f64>();
    joint.iter().zip(by).map(|(r, by)| by * row(r)).sum()
}

fn minus(ship: &ShipMagnetism, other: &ShipMagnetism) -> ShipMagnetism {
    ShipMagnetism {
        chi: std::array::from_fn(|row| {
            std::array::from_fn(|column| ship.chi[row][column] - other.chi[row][column])
        }),
        b_nt: std::array::from_fn(|axis| ship.b_nt[axis] - other.b_nt[axis]),
    }
}

/// Averages the horizontal field over the waters, for a model that does not say at which
/// field it contains the needles' part.
fn harmonic_mean_h(adjustment: &Adjustment<'_>) -> f64 {
    let (weights, inverse) = adjustment.waters.iter().fold((0.0, 0.0), |sum, w| {
        (sum.0 + w.weight, sum.1 + w.weight / w.h_nt)
    });
    weights / inverse
}
