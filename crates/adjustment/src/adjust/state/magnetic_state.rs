//! The ship as she is known at the berth, and with any other setting.
//!
//! `base` is she without correctors: what was measured less the effect of the setting
//! then. The needles' part of that effect was fitted at a mean H of her waters.

use super::corrector_errors::setting_errors;
use super::field_drift::FieldDrift;
use crate::adjust::diagnosis::VerticalCheck;
use crate::adjust::inputs::{AdjustError, Adjustment, VerticalReading};
use crate::berth::{BerthEstimate, JointCovariance, lambda_at_berth};
use crate::binnacle::{BarSetting, Binnacle, Setting, Soft};
use crate::corrector::{Effect, Iron, effect};
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::model::{Covariance, Model, Parameters};
use binnacle_compass::ship::{EarthField, PARAMETERS, ShipMagnetism};

const LAMBDA: usize = PARAMETERS + 1;

type JointRow = [f64; LAMBDA + 1];

pub(crate) struct MagneticState<'a> {
    pub(crate) binnacle: &'a Binnacle,
    model: &'a Model,
    pub(crate) estimate: BerthEstimate,
    joint: JointCovariance,
    pub(crate) drift: FieldDrift,
    lambda: f64,
    base: ShipMagnetism,
    /// What the correctors did while the ship was measured.
    measured_effect: Effect,
    /// The horizontal field at which the needles' part was fitted, nT.
    reference_h_nt: f64,
    pub(crate) may_move_pair: bool,
    pub(crate) may_move_bar: bool,
    /// The vertical field at the berth, if it was read so that it can be believed.
    pub(crate) vertical: Option<VerticalReading>,
}

impl<'a> MagneticState<'a> {
    pub(crate) fn new(adjustment: &Adjustment<'a>) -> Result<MagneticState<'a>, AdjustError> {
        let binnacle = adjustment.binnacle;
        let measured_effect = effect(binnacle, &binnacle.setting);
        let reference_h_nt = harmonic_mean_h(adjustment);
        let model = adjustment.model;
        let needle = needle_only(&measured_effect, reference_h_nt);
        let p = &model.parameters_over_lambda;
        let mut lambda = 0.9;
        let mut estimate;
        let mut rounds = 0;
        // The magnetometer meets no needles; what they take off D is known but for λ,
        // to which they add nothing.
        loop {
            let without = minus(&ShipMagnetism::from_parameters(p, lambda), &needle);
            let parameters = without.parameters_over_lambda();
            let parameters = parameters.map_err(|_| DeviationError::NotFinite)?;
            let without = Model {
                parameters_over_lambda: parameters,
                ..model.clone()
            };
            estimate = lambda_at_berth(&without, adjustment.earth, adjustment.reading)?;
            lambda = estimate.lambda.value;
            rounds += 1;
            if rounds == 4 {
                break;
            }
        }
        let mut joint = estimate.covariance.unwrap_or_default();
        joint[LAMBDA][LAMBDA] += (lambda * adjustment.scale_sd).powi(2);
        let drift = FieldDrift::new(adjustment, &estimate, joint[LAMBDA][LAMBDA]);
        drift.widen(&mut joint);
        let measured = ShipMagnetism::from_parameters(p, lambda);
        let base = minus(&measured, &measured_effect.as_ship(reference_h_nt));
        let mut state = MagneticState {
            binnacle,
            model,
            estimate,
            joint,
            drift,
            lambda,
            base,
            measured_effect,
            reference_h_nt,
            may_move_pair: true,
            may_move_bar: model.identifiable.is_none_or(|known| known.chi13),
            vertical: adjustment
                .vertical
                .filter(|read| VerticalCheck::new(*read, adjustment.earth, binnacle).is_credible()),
        };
        state.may_move_pair = state.lambda_sd_share() <= adjustment.limits.lambda_sd;
        Ok(state)
    }

    /// As if λ were sure enough for spheres to be moved.
    pub(crate) fn with_free_spheres(&self) -> MagneticState<'a> {
        MagneticState {
            may_move_pair: true,
            ..*self
        }
    }

    pub(crate) fn constant_deg(&self) -> f64 {
        self.model.constant_deg
    }

    /// Standard error of λ, as a share of it.
    pub(crate) fn lambda_sd_share(&self) -> f64 {
        self.joint[LAMBDA][LAMBDA].sqrt() / self.lambda
    }

    /// The whole ship with correctors of this effect, where the horizontal field is H.
    pub(crate) fn with_effect(&self, effect: &Effect, h_nt: f64) -> ShipMagnetism {
        let chi = effect.chi_at(h_nt);
        ShipMagnetism {
            chi: std::array::from_fn(|row| {
                std::array::from_fn(|column| self.base.chi[row][column] + chi[row][column])
            }),
            b_nt: std::array::from_fn(|axis| self.base.b_nt[axis] + effect.b_nt[axis]),
        }
    }

    /// What of a unit of vertical field is induced across the card with a bar: the size
    /// of χ13 and χ23 together.
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

    /// How far the vertical field per earth's vertical field is from what it was.
    pub(crate) fn chi33_change(&self, effect: &Effect) -> f64 {
        effect.chi[2][2] - self.measured_effect.chi[2][2]
    }

    /// How far the permanent vertical field is from what it was, nT.
    pub(crate) fn bz_change(&self, effect: &Effect) -> f64 {
        effect.b_nt[2] - self.measured_effect.b_nt[2]
    }

    /// The model that holds with a setting: its covariance carries the errors of the
    /// old model, of λ, and of every corrector that was moved (docs/science.md, eq. 24).
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
            ..self.model.clone()
        })
    }

    /// The same for another horizontal field, where the needles count differently.
    pub(crate) fn model_at(
        &self,
        model: &Model,
        setting: &Setting,
        earth: EarthField,
    ) -> Result<Model, DeviationError> {
        let ship = self.with_effect(&effect(self.binnacle, setting), earth.h_nt);
        let parameters = ship.parameters_over_lambda();
        Ok(Model {
            parameters_over_lambda: parameters.map_err(|_| DeviationError::NotFinite)?,
            ..model.clone()
        })
    }

    fn covariance(
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

    /// Rows of the slopes of the eight that hold then by the nine that were measured.
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

    /// What an effect that comes on top makes of the eight.
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

    /// All that is known of the ship with a setting, for what is read then.
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

/// The ship with a setting, as she is known before anything is read of her then.
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
    /// What an effect that comes on top makes of the model's eight.
    pub(crate) fn sensitivity(&self, effect: &Effect) -> [f64; LAMBDA] {
        self.state.sensitivity(effect, &self.after, self.new_lambda)
    }

    /// Slopes of the model's eight by the eight that were measured and, last, by λ.
    pub(crate) fn slopes(&self) -> &[JointRow; LAMBDA] {
        &self.slopes
    }
}

impl MagneticState<'_> {
    pub(crate) fn lambda(&self) -> f64 {
        self.lambda
    }

    /// Of the eight that were measured and, last, λ, the magnetometer's scale included.
    pub(crate) fn joint(&self) -> &JointCovariance {
        &self.joint
    }

    /// What the correctors did while the ship was measured.
    pub(crate) fn measured_effect(&self) -> &Effect {
        &self.measured_effect
    }

    /// The horizontal field at the card without bowl and needles, nT, with correctors of
    /// this effect in a field of the earth in ship axes.
    pub(crate) fn field(&self, effect: &Effect, earth: [f64; 3]) -> [f64; 2] {
        let [x, y, _] = self
            .with_effect(effect, f64::INFINITY)
            .field_at_compass(earth);
        [x, y]
    }
}

/// The seven of an effect, not over λ, in the order of the parameters.
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

fn needle_only(effect: &Effect, h_nt: f64) -> ShipMagnetism {
    Effect {
        needle_nt: effect.needle_nt,
        ..Effect::default()
    }
    .as_ship(h_nt)
}

/// What the needles did to the fitted D is their mean over where it was fitted.
fn harmonic_mean_h(adjustment: &Adjustment<'_>) -> f64 {
    let (weights, inverse) = adjustment.waters.iter().fold((0.0, 0.0), |sum, w| {
        (sum.0 + w.weight, sum.1 + w.weight / w.h_nt)
    });
    weights / inverse
}
