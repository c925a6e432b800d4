//! Prediction updated by a second reading or by the steps' turns.

use super::hypotheses::Weighed;
use super::innovation::{EIGHT, Eight};
use super::result::Learnt;
use crate::adjust::inputs::{AdjustError, Adjustment};
use crate::adjust::prediction::{PredictedTable, tables_by};
use crate::adjust::state::{Condition, Known};
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::model::{Model, Parameters};
use binnacle_compass::ship::PARAMETERS;
use nalgebra::SMatrix;

/// The mean of all that may be, and its spread.
pub(crate) fn learnt(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    known: &Known<'_>,
    weighed: &[Weighed],
) -> Result<Learnt, AdjustError> {
    let mean: Eight = weighed.iter().map(|one| one.correction * one.share).sum();
    let mut spread = SMatrix::<f64, EIGHT, EIGHT>::zeros();
    for one in weighed {
        let apart = one.correction - mean;
        spread += (one.covariance + apart * apart.transpose()) * one.share;
    }
    let spread = (spread + spread.transpose()) / 2.0;
    let model_after = corrected(&known.model, &mean, &spread);
    let after = tables_by(adjustment, |earth| {
        let foretold = condition.model_at(&known.model, &known.setting, earth)?;
        Ok::<Model, DeviationError>(corrected(&foretold, &mean, &spread))
    })?;
    let greatest =
        |of: fn(&PredictedTable) -> Option<f64>| after.iter().filter_map(of).fold(0.0, f64::max);
    Ok(Learnt {
        worst_residual_deg: greatest(|table| table.worst_deg),
        widest_band_deg: greatest(|table| table.widest_band_deg),
        model_after,
        after,
    })
}

fn corrected(model: &Model, correction: &Eight, covariance: &SMatrix<f64, EIGHT, EIGHT>) -> Model {
    let parameters = model.parameters_over_lambda.to_array();
    let parameters = std::array::from_fn(|i| parameters[i] + correction[i]);
    Model {
        parameters_over_lambda: Parameters::from_array(parameters),
        constant_deg: model.constant_deg + correction[PARAMETERS],
        covariance: Some(covariance.transpose().into()),
        ..model.clone()
    }
}
