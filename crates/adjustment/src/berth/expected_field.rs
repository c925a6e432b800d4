//! Field over λ expected by the model at the berth, and error propagation of quantities
//! derived from it and the reading.

use super::error::BerthError;
use super::reading::{Alignment, BerthReading};
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::model::{Covariance, Model, Parameters};
use binnacle_compass::ship::{EarthField, PARAMETERS};

/// Seven parameters and the constant.
pub(super) const UNKNOWNS: usize = PARAMETERS + 1;

/// Least directive force, as a share of its mean; with less, direction and strength are
/// small differences of large numbers.
const LEAST_DIRECTIVE_FORCE: f64 = 0.1;

/// A horizontal vector, `[forward, starboard]`.
pub(super) type Vector = [f64; 2];

/// Expected u = B/λ by the model, with its slopes.
pub(super) struct ExpectedField {
    /// Expected field over λ, nT.
    pub(super) u: Vector,
    /// Slope by the magnetic heading, nT per radian.
    by_heading: Vector,
    /// Slopes by the parameters in their order and by the constant in degrees.
    pub(super) by_unknown: [Vector; UNKNOWNS],
}

/// Gradient of a quantity by the model's unknowns, and its variance from all errors of the
/// reading.
pub(super) struct Spread {
    pub(super) by_unknown: [f64; UNKNOWNS],
    pub(super) reading_variance: f64,
}

/// Returns the slope of the field over λ by the magnetic heading, nT per radian, for the
/// earth's field in ship axes.
fn slope_by_heading(p: &Parameters, [hx, hy, _]: [f64; 3]) -> Vector {
    let d = p.chi11_minus_chi22 / 2.0;
    // As the ship turns to starboard, the field turns to port: dHx = Hy, dHy = −Hx.
    [(1.0 + d) * hy - p.chi12 * hx, p.chi21 * hy - (1.0 - d) * hx]
}

/// Returns the slopes of the field over λ by the parameters in their order and by the
/// constant in degrees, which changes the heading by `heading_by_constant` radians per
/// degree.
pub(crate) fn slopes(
    p: &Parameters,
    earth: [f64; 3],
    heading_by_constant: f64,
) -> [Vector; UNKNOWNS] {
    let [hx, hy, z] = earth;
    [
        [1.0, 0.0],
        [z, 0.0],
        [0.0, 1.0],
        [0.0, z],
        [hx / 2.0, -hy / 2.0],
        [hy, 0.0],
        [0.0, hx],
        slope_by_heading(p, earth).map(|slope| slope * heading_by_constant),
    ]
}

impl ExpectedField {
    /// Computes the field that the model expects for a reading.
    pub(super) fn new(
        model: &Model,
        earth: EarthField,
        reading: &BerthReading,
    ) -> Result<ExpectedField, BerthError> {
        model.check()?;
        let p = &model.parameters_over_lambda;
        let coefficients = Coefficients::new(p, earth)?;
        let (constant_deg, heading_by_constant) = match reading.alignment() {
            Alignment::Keel => (0.0, 0.0),
            Alignment::AsFitted => (model.constant_deg, -1_f64.to_radians()),
        };
        let magnetic_rad = reading.magnetic().radians() - constant_deg.to_radians();
        let directive_force = coefficients.directive_force(magnetic_rad);
        if directive_force < LEAST_DIRECTIVE_FORCE {
            return Err(BerthError::NoDirectiveForce {
                magnetic_deg: binnacle_compass::angle::wrap_360(magnetic_rad.to_degrees()),
                directive_force,
            });
        }
        let in_ship_axes = earth.in_ship_axes(magnetic_rad);
        Ok(ExpectedField {
            u: p.field_over_lambda(magnetic_rad, earth),
            by_heading: slope_by_heading(p, in_ship_axes),
            by_unknown: slopes(p, in_ship_axes, heading_by_constant),
        })
    }

    /// Returns the covariance of the measured parts by the reading's own errors, nT².
    pub(super) fn part_errors(
        &self,
        reading: &BerthReading,
        earth: EarthField,
        lambda: f64,
    ) -> [Vector; 2] {
        let errors = reading.errors();
        let [forward, starboard] = reading.field_nt();
        let leaked_nt = earth.z_nt * errors.tilt_sd_deg.to_radians();
        let each_part = errors.field_sd_nt.powi(2) + leaked_nt.powi(2);
        let turned = errors.alignment_sd_deg.to_radians();
        let turned = [starboard * turned, -forward * turned];
        let headed = errors.heading_sd_deg.to_radians() * lambda;
        let headed = self.by_heading.map(|part| part * headed);
        std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                let own = if row == column { each_part } else { 0.0 };
                own + turned[row] * turned[column] + headed[row] * headed[column]
            })
        })
    }

    /// Propagates errors to a quantity with these slopes by the measured field and by u.
    pub(super) fn spread(
        &self,
        reading: &BerthReading,
        earth: EarthField,
        by_b: Vector,
        by_u: Vector,
    ) -> Spread {
        let errors = reading.errors();
        let [forward, starboard] = reading.field_nt();
        // The ship's own vertical field is not known here; the earth's is most of it.
        let leaked_nt = earth.z_nt * errors.tilt_sd_deg.to_radians();
        let each_part = errors.field_sd_nt.powi(2) + leaked_nt.powi(2);
        let turned = dot(by_b, [starboard, -forward]) * errors.alignment_sd_deg.to_radians();
        let headed = dot(by_u, self.by_heading) * errors.heading_sd_deg.to_radians();
        Spread {
            by_unknown: self.by_unknown.map(|slope| dot(by_u, slope)),
            reading_variance: dot(by_b, by_b) * each_part + turned.powi(2) + headed.powi(2),
        }
    }
}

impl Spread {
    /// Returns the variance from reading and model together.
    pub(super) fn variance(&self, covariance: &Covariance) -> f64 {
        let with_each = covariances(covariance, &self.by_unknown);
        let from_model: f64 = with_each
            .iter()
            .zip(self.by_unknown)
            .map(|(c, g)| c * g)
            .sum();
        // Rounding may make a variance of zero slightly negative.
        from_model.max(0.0) + self.reading_variance
    }

    /// Returns the standard error from reading and model together.
    pub(super) fn standard_error(&self, covariance: Option<&Covariance>) -> Option<f64> {
        covariance.map(|covariance| self.variance(covariance).sqrt())
    }
}

/// Returns the covariance of each unknown with a quantity of this gradient.
pub(super) fn covariances(covariance: &Covariance, gradient: &[f64; UNKNOWNS]) -> [f64; UNKNOWNS] {
    covariance.map(|row| row.iter().zip(gradient).map(|(c, g)| c * g).sum())
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
