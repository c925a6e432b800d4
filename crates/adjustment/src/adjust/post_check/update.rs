//! Prediction updated by a second reading or by the steps' turns.

use super::hypotheses::Posterior;
use super::innovation::{MODEL_SIZE, ModelVector};
use super::result::UpdatedPrediction;
use crate::adjust::inputs::{AdjustError, Adjustment};
use crate::adjust::prediction::{PredictedTable, tables_by};
use crate::adjust::state::StateWithSetting;
use binnacle_compass::model::{Model, Parameters};
use binnacle_compass::ship::PARAMETERS;
use nalgebra::SMatrix;

/// Combines the posteriors of all hypotheses to a mean and its covariance.
pub(crate) fn update_prediction(
    adjustment: &Adjustment<'_>,
    known: &StateWithSetting<'_>,
    posterior: &[Posterior],
) -> Result<UpdatedPrediction, AdjustError> {
    let mean: ModelVector = posterior.iter().map(|one| one.correction * one.share).sum();
    let mut spread = SMatrix::<f64, MODEL_SIZE, MODEL_SIZE>::zeros();
    for one in posterior {
        let apart = one.correction - mean;
        spread += (one.covariance + apart * apart.transpose()) * one.share;
    }
    let spread = (spread + spread.transpose()) / 2.0;
    let model_after = corrected_model(&known.model, &mean, &spread);
    let after = tables_by(adjustment, &model_after)?;
    let greatest =
        |of: fn(&PredictedTable) -> Option<f64>| after.iter().filter_map(of).fold(0.0, f64::max);
    Ok(UpdatedPrediction {
        worst_residual_deg: greatest(|table| table.worst_deg),
        widest_band_deg: greatest(|table| table.widest_band_deg),
        model_after,
        after,
    })
}

fn corrected_model(
    model: &Model,
    correction: &ModelVector,
    covariance: &SMatrix<f64, MODEL_SIZE, MODEL_SIZE>,
) -> Model {
    let parameters = model.parameters_over_lambda.to_array();
    let parameters = std::array::from_fn(|i| parameters[i] + correction[i]);
    Model {
        parameters_over_lambda: Parameters::from_array(parameters),
        constant_deg: model.constant_deg + correction[PARAMETERS],
        covariance: Some(covariance.transpose().into()),
        ..model.clone()
    }
}
