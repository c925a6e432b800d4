//! Innovation of a second reading, and its covariance with the errors of the plan's model
//! (docs/science.md, §11).
//!
//! Invariants: every independent error of one standard deviation occurs once, with its
//! effect on the reading and on the model. The magnetometer's scale is common to both
//! readings, so it affects only the change by the correctors. Its alignment and levelling
//! are new each time.

use crate::adjust::inputs::{Adjustment, VerticalReading};
use crate::adjust::state::{MagneticState, StateWithSetting, setting_errors};
use crate::berth::{Alignment, BerthReading, slopes};
use crate::corrector::Effect;
use binnacle_compass::ship::PARAMETERS;
use nalgebra::{SMatrix, SVector};

/// Number of parameters with the constant.
pub(crate) const MODEL_SIZE: usize = PARAMETERS + 1;
/// Number of unknowns with λ.
const JOINT_SIZE: usize = MODEL_SIZE + 1;

/// Field, `[forward, starboard, down]`, nT.
pub(crate) type FieldVector = SVector<f64, 3>;
pub(crate) type ModelVector = SVector<f64, MODEL_SIZE>;

/// Effect of one error on the reading and on the model.
#[derive(Clone, Copy)]
pub(crate) struct Perturbation {
    pub(crate) of_reading: FieldVector,
    pub(crate) of_model: ModelVector,
}

/// Second reading with its prediction.
pub(crate) struct Innovation {
    pub(crate) expected: FieldVector,
    pub(crate) read: FieldVector,
    /// Vertical part measured both times.
    pub(crate) is_vertical_known: bool,
    /// Earth's field in ship axes.
    earth: [f64; 3],
    /// Covariance of read less expected; an unmeasured part has variance one and no
    /// correlation.
    pub(crate) spread: SMatrix<f64, 3, 3>,
    /// Covariance of the model's unknowns with the innovation.
    pub(crate) cross_covariance: SMatrix<f64, MODEL_SIZE, 3>,
}

impl Innovation {
    pub(crate) fn new(
        adjustment: &Adjustment<'_>,
        state: &MagneticState<'_>,
        known: &StateWithSetting<'_>,
        reading: &BerthReading,
        vertical: Option<VerticalReading>,
    ) -> Innovation {
        let first = adjustment.reading;
        let [first_earth, earth] =
            [first, reading].map(|r| earth_in_ship_axes(adjustment, state, r));
        let was = state.field(state.measured_effect(), first_earth);
        let expected = state.field(&known.effect, earth);
        let verticals = adjustment.vertical.zip(vertical);
        let (was_down, down) = verticals.map_or((0.0, 0.0), |(was, _)| {
            let part = |effect: &Effect, earth: [f64; 3]| down_of(effect, earth);
            let change = part(&known.effect, earth) - part(state.measured_effect(), first_earth);
            (was.down_nt, was.down_nt + change)
        });
        let [forward, starboard] = reading.field_nt();
        let mut innovation = Innovation {
            expected: FieldVector::new(expected[0], expected[1], down),
            read: FieldVector::new(
                forward,
                starboard,
                verticals.map_or(0.0, |(_, now)| now.down_nt),
            ),
            is_vertical_known: verticals.is_some(),
            earth,
            spread: SMatrix::zeros(),
            cross_covariance: SMatrix::zeros(),
        };
        innovation.add_model(adjustment, state, known, reading);
        let was = FieldVector::new(was[0], was[1], was_down);
        for perturbation in innovation.perturbations(adjustment, state, known, reading, was) {
            innovation.add(&perturbation);
        }
        if !innovation.is_vertical_known {
            innovation.spread[(2, 2)] = 1.0;
        }
        innovation
    }

    /// Returns the perturbation by an additional effect.
    pub(crate) fn perturbation(
        &self,
        known: &StateWithSetting<'_>,
        effect: &Effect,
    ) -> Perturbation {
        let field = |axis: usize| {
            let induced = effect.chi[axis].iter().zip(self.earth);
            effect.b_nt[axis] + induced.map(|(chi, earth)| chi * earth).sum::<f64>()
        };
        Perturbation {
            of_reading: self.masked(FieldVector::from_fn(|axis, _| field(axis))),
            of_model: ModelVector::from(known.sensitivity(effect)),
        }
    }

    pub(crate) fn difference(&self) -> FieldVector {
        self.read - self.expected
    }

    fn masked(&self, mut field: FieldVector) -> FieldVector {
        if !self.is_vertical_known {
            field[2] = 0.0;
        }
        field
    }

    fn add(&mut self, perturbation: &Perturbation) {
        self.spread += perturbation.of_reading * perturbation.of_reading.transpose();
        self.cross_covariance += perturbation.of_model * perturbation.of_reading.transpose();
    }

    /// Adds the errors of model and λ, without the magnetometer's scale.
    fn add_model(
        &mut self,
        adjustment: &Adjustment<'_>,
        state: &MagneticState<'_>,
        known: &StateWithSetting<'_>,
        reading: &BerthReading,
    ) {
        let p = &adjustment.model.parameters_over_lambda;
        let heading_by_constant = match reading.alignment() {
            Alignment::Keel => 0.0,
            Alignment::AsFitted => -1_f64.to_radians(),
        };
        let by_unknown = slopes(p, self.earth, heading_by_constant);
        let over_lambda = p.field_over_lambda_in_ship_axes(self.earth);
        let lambda = state.lambda();
        let by_nine = SMatrix::<f64, 3, JOINT_SIZE>::from_fn(|axis, unknown| match axis {
            2 => 0.0,
            _ => by_unknown
                .get(unknown)
                .map_or(over_lambda[axis], |slope| lambda * slope[axis]),
        });
        let mut joint = SMatrix::<f64, JOINT_SIZE, JOINT_SIZE>::from_fn(|row, column| {
            state.joint()[row][column]
        });
        joint[(MODEL_SIZE, MODEL_SIZE)] -= (lambda * adjustment.scale_sd).powi(2);
        let slopes = SMatrix::<f64, MODEL_SIZE, JOINT_SIZE>::from_fn(|row, column| {
            known.slopes()[row][column]
        });
        self.spread += by_nine * joint * by_nine.transpose();
        self.cross_covariance += slopes * joint * by_nine.transpose();
    }

    /// Lists all other errors.
    fn perturbations(
        &self,
        adjustment: &Adjustment<'_>,
        state: &MagneticState<'_>,
        known: &StateWithSetting<'_>,
        reading: &BerthReading,
        was: FieldVector,
    ) -> Vec<Perturbation> {
        let of_reading = |x: f64, y: f64, z: f64| Perturbation {
            of_reading: self.masked(FieldVector::new(x, y, z)),
            of_model: ModelVector::zeros(),
        };
        let effects = setting_errors(state.binnacle, &known.setting).into_iter();
        let mut perturbations: Vec<Perturbation> = effects
            .map(|effect| self.perturbation(known, &effect))
            .collect();

        // λ is too great by the scale's error, and so is its prediction.
        let by_lambda = known.slopes().map(|row| row[MODEL_SIZE]);
        let scale = adjustment.scale_sd;
        perturbations.push(Perturbation {
            of_reading: self.masked((self.expected - was) * scale),
            of_model: ModelVector::from(by_lambda) * (-state.lambda() * scale),
        });

        let errors = reading.errors();
        let noise = errors.field_sd_nt;
        perturbations.push(of_reading(noise, 0.0, 0.0));
        perturbations.push(of_reading(0.0, noise, 0.0));
        perturbations.push(of_reading(0.0, 0.0, noise));
        let [x, y, z] = [self.expected[0], self.expected[1], self.expected[2]];
        let alignment = errors.alignment_sd_deg.to_radians();
        perturbations.push(of_reading(y * alignment, -x * alignment, 0.0));
        // Without a vertical reading, the vertical field at the compass is approximately
        // the earth's.
        let down = if self.is_vertical_known {
            z
        } else {
            self.earth[2]
        };
        let tilt = errors.tilt_sd_deg.to_radians();
        perturbations.push(of_reading(down * tilt, 0.0, -x * tilt));
        perturbations.push(of_reading(0.0, down * tilt, -y * tilt));

        // The given heading is the same as before.
        let heading = errors.heading_sd_deg.to_radians();
        let [hx, hy, _] = self.earth;
        let ahead = state.field(
            &known.effect,
            [hx + hy * heading, hy - hx * heading, self.earth[2]],
        );
        perturbations.push(of_reading(ahead[0] - x, ahead[1] - y, 0.0));

        // The vertical part repeats the first reading's errors.
        let first = adjustment.reading.errors();
        let tilt = first.tilt_sd_deg.to_radians();
        let of_first = [first.field_sd_nt, was[0] * tilt, was[1] * tilt];
        perturbations.extend(of_first.map(|down| of_reading(0.0, 0.0, down)));
        perturbations
    }
}

fn earth_in_ship_axes(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    reading: &BerthReading,
) -> [f64; 3] {
    let aligned_deg = match reading.alignment() {
        Alignment::Keel => 0.0,
        Alignment::AsFitted => state.constant_deg(),
    };
    let magnetic_deg = reading.magnetic().degrees() - aligned_deg;
    adjustment.earth.in_ship_axes(magnetic_deg.to_radians())
}

fn down_of(effect: &Effect, earth: [f64; 3]) -> f64 {
    let induced = effect.chi[2].iter().zip(earth);
    effect.b_nt[2] + induced.map(|(chi, earth)| chi * earth).sum::<f64>()
}
