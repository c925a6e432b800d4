//! Mixture of two models, where the state of the vessel is not known.
//!
//! The band is no narrower than the probabilities of the two models require.

use binnacle_compass::model::{Model, Parameters};
use binnacle_compass::ship::PARAMETERS;

/// Returns mean and covariance of a vessel that is `other` with a probability, and
/// otherwise `one`. All else is taken from the likelier model. None unless both have a
/// covariance.
pub(super) fn mixture(one: &Model, other: &Model, probability: f64) -> Option<Model> {
    let weights = [1.0 - probability, probability];
    let means = [one, other].map(as_vector);
    let covariances = [one.covariance?, other.covariance?];
    let mut mean = [0.0; PARAMETERS + 1];
    for (weight, of) in weights.iter().zip(&means) {
        for (m, x) in mean.iter_mut().zip(of) {
            *m += weight * x;
        }
    }
    let mut covariance = [[0.0; PARAMETERS + 1]; PARAMETERS + 1];
    for ((weight, of), own) in weights.iter().zip(&means).zip(&covariances) {
        for i in 0..=PARAMETERS {
            for j in 0..=PARAMETERS {
                let apart = (of[i] - mean[i]) * (of[j] - mean[j]);
                covariance[i][j] += weight * (own[i][j] + apart);
            }
        }
    }
    let mut parameters = [0.0; PARAMETERS];
    parameters.copy_from_slice(&mean[..PARAMETERS]);
    let likelier = if probability > 0.5 { other } else { one };
    Some(Model {
        parameters_over_lambda: Parameters::from_array(parameters),
        constant_deg: mean[PARAMETERS],
        covariance: Some(covariance),
        ..likelier.clone()
    })
}

fn as_vector(model: &Model) -> [f64; PARAMETERS + 1] {
    let mut vector = [0.0; PARAMETERS + 1];
    vector[..PARAMETERS].copy_from_slice(&model.parameters_over_lambda.to_array());
    vector[PARAMETERS] = model.constant_deg;
    vector
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_band_holds_both_of_two_ships_that_are_as_likely() {
        let text = r#"{"parameters_over_lambda": {"bx_nt": 1000, "chi13": 0, "by_nt": 0,
            "chi23": 0, "chi11_minus_chi22": 0, "chi12": 0, "chi21": 0}, "constant_deg": 0}"#;
        let mut one: Model = serde_json::from_str(text).unwrap();
        let mut known = [[0.0; 8]; 8];
        known[0][0] = 50.0 * 50.0;
        one.covariance = Some(known);
        let mut other = one.clone();
        other.parameters_over_lambda.bx_nt = -1000.0;

        let open = mixture(&one, &other, 0.5).unwrap();
        assert!(open.parameters_over_lambda.bx_nt.abs() < 1e-9);
        let se = open.covariance.unwrap()[0][0].sqrt();
        assert!((se - 50.0_f64.hypot(1000.0)).abs() < 1e-6, "{se}");

        let certain = mixture(&one, &other, 1.0).unwrap();
        assert!((certain.parameters_over_lambda.bx_nt + 1000.0).abs() < 1e-9);
        assert!((certain.covariance.unwrap()[0][0] - 2500.0).abs() < 1e-6);
    }
}
