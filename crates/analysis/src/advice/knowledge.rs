//! Knowledge of a vessel's deviation, and the gain of a watch.
//!
//! Learning never widens a band. The reference's constant error, which no heading can show,
//! is learnt from azimuths alone.

use super::question::AdviceError;
use binnacle_compass::coverage::HEADING_STEP_DEG;
use binnacle_compass::deviation::{DeviationError, NORMAL_95, linearised_at_compass};
use binnacle_compass::model::Model;
use binnacle_compass::result::Band;
use binnacle_compass::ship::{EarthField, PARAMETERS};
use nalgebra::{Matrix3, SMatrix, SVector};

/// Number of sectors of heading.
pub(super) const SECTORS: usize = 360 / HEADING_STEP_DEG as usize;

/// Number of unknowns: parameters and constant, as in the covariance.
const UNKNOWNS: usize = PARAMETERS + 1;
type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
/// Slopes of a deviation in degrees by parameters and constant.
pub(super) type Slope = SVector<f64, UNKNOWNS>;

/// Returns the slopes of deviation in the middle of each sector.
///
/// # Errors
/// Fails when the field is too weak for a compass or headings are ambiguous in it.
pub(super) fn slopes(model: &Model, earth: EarthField) -> Result<[Slope; SECTORS], DeviationError> {
    let mut slopes = [Slope::zeros(); SECTORS];
    for (sector, slope) in slopes.iter_mut().enumerate() {
        let compass = (sector as f64 + 0.5) * f64::from(HEADING_STEP_DEG);
        let (_, gradient) =
            linearised_at_compass(&model.parameters_over_lambda, compass.to_radians(), earth)?;
        for (by, radians) in slope.iter_mut().zip(gradient) {
            *by = radians.to_degrees();
        }
        slope[PARAMETERS] = 1.0;
    }
    Ok(slopes)
}

/// Waters in which the band is to be narrow, on every heading.
pub(super) struct Waters {
    slopes: Vec<Slope>,
    /// Mean of slope times slope: the mean variance over the waters is the trace of this
    /// times the covariance.
    moments: Matrix,
}

impl Waters {
    /// Makes waters of at least one slope.
    pub(super) fn new(slopes: Vec<Slope>) -> Waters {
        let sum: Matrix = slopes.iter().map(|g| g * g.transpose()).sum();
        Waters {
            moments: sum / slopes.len() as f64,
            slopes,
        }
    }
}

/// Covariance without what cannot be learnt.
#[derive(Clone, Debug)]
pub(super) struct Knowledge {
    covariance: Matrix,
    /// Variance of the reference's constant error, degrees squared.
    reference: f64,
}

impl Knowledge {
    /// Takes the reference's constant out of a model's covariance.
    pub(super) fn new(model: &Model, constant_sd_deg: f64) -> Result<Knowledge, AdviceError> {
        let given = model.covariance.ok_or(AdviceError::NoCovariance)?;
        let mut covariance = Matrix::from_fn(|i, j| f64::midpoint(given[i][j], given[j][i]));
        let information = covariance
            .cholesky()
            .ok_or(AdviceError::NotACovariance)?
            .inverse();
        // The reference's part is limited by the covariance.
        let most = 1.0 / information[(PARAMETERS, PARAMETERS)];
        let reference = constant_sd_deg.powi(2).min(most);
        if !(reference.is_finite() && covariance.iter().all(|v| v.is_finite())) {
            return Err(AdviceError::NotACovariance);
        }
        covariance[(PARAMETERS, PARAMETERS)] -= reference;
        Ok(Knowledge {
            covariance,
            reference,
        })
    }

    /// Returns the knowledge in which the reference's constant can be learnt, too.
    pub(super) fn with_reference(&self) -> Knowledge {
        let mut open = self.clone();
        open.covariance[(PARAMETERS, PARAMETERS)] += self.reference;
        open.reference = 0.0;
        open
    }

    /// Returns the half-width of the band when everything is learnt, degrees.
    pub(super) fn floor_deg(&self) -> f64 {
        NORMAL_95 * self.reference.sqrt()
    }

    pub(super) fn band(&self, waters: &Waters) -> Band {
        let half_width =
            |variance: f64| (NORMAL_95 * (variance.max(0.0) + self.reference).sqrt()).min(180.0);
        let worst = waters
            .slopes
            .iter()
            .map(|g| g.dot(&(self.covariance * g)))
            .fold(0.0, f64::max);
        Band {
            rms_deg: half_width((self.covariance * waters.moments).trace()),
            worst_deg: half_width(worst),
        }
    }

    /// Returns the reduction of the mean variance over the waters by a row of variance 1.
    fn gain(&self, row: &Slope, waters: &Waters) -> f64 {
        let learnt = self.covariance * row;
        learnt.dot(&(waters.moments * learnt)) / (row.dot(&learnt) + 1.0)
    }

    /// Adds a row of variance 1 (docs/science.md, eq. 15).
    pub(super) fn learn(&mut self, row: &Slope) {
        let learnt = self.covariance * row;
        let share = 1.0 / (row.dot(&learnt) + 1.0);
        self.covariance -= learnt * learnt.transpose() * share;
    }
}

/// Successive watches in one field, whose errors are correlated.
#[derive(Clone)]
pub(super) struct Visit {
    pub(super) knowledge: Knowledge,
    /// Cholesky factor of the errors' covariance: it whitens the rows.
    factor: Matrix3<f64>,
    rows: Vec<Slope>,
}

impl Visit {
    /// Makes a visit; none when `errors` is not positive definite.
    pub(super) fn new(knowledge: &Knowledge, errors: Matrix3<f64>) -> Option<Visit> {
        Some(Visit {
            knowledge: knowledge.clone(),
            factor: errors.cholesky()?.l(),
            rows: Vec::new(),
        })
    }

    /// Returns the gain of the next watch.
    pub(super) fn gain(&self, slope: &Slope, waters: &Waters) -> f64 {
        self.knowledge.gain(&self.whitened(slope), waters)
    }

    /// Adds a watch.
    pub(super) fn watch(&mut self, slope: &Slope) {
        let row = self.whitened(slope);
        self.knowledge.learn(&row);
        self.rows.push(row);
    }

    fn whitened(&self, slope: &Slope) -> Slope {
        let next = self.rows.len();
        let mut row = *slope;
        for (before, whitened) in self.rows.iter().enumerate() {
            row -= whitened * self.factor[(next, before)];
        }
        row / self.factor[(next, next)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knowledge() -> Knowledge {
        let sd = Slope::from([1500.0, 0.012, 1500.0, 0.006, 0.02, 0.008, 0.008, 3.0]);
        Knowledge {
            covariance: Matrix::from_diagonal(&sd.component_mul(&sd)),
            reference: 0.25,
        }
    }

    fn slope(index: i32) -> Slope {
        let turn = f64::from(index);
        Slope::from([
            2e-3 * turn.sin(),
            80.0 * turn.sin(),
            2e-3 * turn.cos(),
            80.0 * turn.cos(),
            20.0,
            10.0 * turn,
            -5.0,
            1.0,
        ])
    }

    /// Successive watches give the same result as all at once by the information.
    #[test]
    fn a_visits_watches_add_their_joint_information() {
        let errors = Matrix3::new(0.1, 0.06, 0.05, 0.06, 0.1, 0.06, 0.05, 0.06, 0.1);
        let mut visit = Visit::new(&knowledge(), errors).unwrap();
        let rows = [slope(1), slope(2), slope(4)];
        let waters = Waters::new(vec![slope(0), slope(3)]);
        let mut design = SMatrix::<f64, 3, UNKNOWNS>::zeros();
        for (index, row) in rows.iter().enumerate() {
            let before = visit.knowledge.band(&waters).rms_deg.powi(2);
            let gain = visit.gain(row, &waters);
            visit.watch(row);
            let after = visit.knowledge.band(&waters).rms_deg.powi(2);
            let expected = NORMAL_95.powi(2) * gain;
            assert!((before - after - expected).abs() < 1e-9 * before);
            design.set_row(index, &row.transpose());
        }
        let information = knowledge().covariance.try_inverse().unwrap()
            + design.transpose() * errors.try_inverse().unwrap() * design;
        let expected = information.try_inverse().unwrap();
        for (found, expected) in visit.knowledge.covariance.iter().zip(expected.iter()) {
            let scale = expected.abs().max(1e-9);
            assert!(
                (found - expected).abs() < 1e-6 * scale,
                "{found} {expected}"
            );
        }
    }
}
