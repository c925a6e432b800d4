//! Policy that decides whether an agent gets a newer model. A model costs more bytes than the
//! samples that it was fitted to.
//!
//! Invariants: a model of another epoch is sent. So is one whose difference shows on board, or one
//! three days younger than the agent's.

use super::StoredModel;
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::model::Model;

/// Difference that shows on board, degrees: a card is read to half a degree, a heading to a tenth.
const LEAST_DEG: f64 = 0.1;
/// Fraction of the known band within which a difference does not matter.
const OF_BAND: f64 = 0.25;
/// Age beyond an agent's model at which a newer one is sent, seconds: the bridge shows the age.
const OLDER_S: f64 = 3.0 * 86_400.0;
const STEP_DEG: u32 = 10;
/// Age beyond which a predicted model is replaced, whatever its certainty, seconds.
const PREDICTION_VALID_S: f64 = 60.0 * 86_400.0;
/// Usual drift of bx and by in [`DRIFT_S`], nT.
const USUAL_DRIFT_NT: f64 = 60.0;
const DRIFT_S: f64 = 30.0 * 86_400.0;
/// Indices of bx and by among the parameters.
const PERMANENT: [usize; 2] = [0, 2];

impl StoredModel {
    /// Tells whether an agent with an earlier model needs this one. It compares deviation and band
    /// on all headings at the last place, epoch, and age.
    pub fn is_update_of(&self, known: &StoredModel) -> bool {
        let older_s = self.data_until.0.seconds_since(known.data_until.0);
        self.replaces() != known.replaces()
            || self.version < known.version
            || !(0.0..OLDER_S).contains(&older_s)
            || (0..360 / STEP_DEG).any(|index| {
                let compass = CompassHeading::new(f64::from(index * STEP_DEG));
                compass.is_none_or(|compass| self.differs(&known.model.0, compass))
            })
    }

    /// Tells whether it replaces a predicted model. It does when it is more certain on its least
    /// certain heading, or when the prediction is too old to plan from.
    pub fn replaces_prediction(&self, predicted: &StoredModel) -> bool {
        let age_s = self.data_until.0.seconds_since(predicted.data_until.0);
        if age_s > PREDICTION_VALID_S {
            return true;
        }
        let known = drifted(&predicted.model.0, age_s.max(0.0));
        let widest = |model: &Model| {
            let headings = (0..360 / STEP_DEG).filter_map(|index| {
                let compass = CompassHeading::new(f64::from(index * STEP_DEG))?;
                model.deviation(compass, self.earth()).ok()?.band95_deg
            });
            headings.reduce(f64::max)
        };
        match (widest(&self.model.0), widest(&known)) {
            (Some(ours), Some(known)) => ours < known,
            (ours, known) => ours.is_some() || known.is_none(),
        }
    }

    fn differs(&self, known: &Model, compass: CompassHeading) -> bool {
        let ours = self.model.0.deviation(compass, self.earth());
        let (Ok(ours), Ok(known)) = (ours, known.deviation(compass, self.earth())) else {
            return true;
        };
        let moved = ours.deviation.degrees_east() - known.deviation.degrees_east();
        let (Some(band), Some(known)) = (ours.band95_deg, known.band95_deg) else {
            return true;
        };
        let least = LEAST_DEG.max(OF_BAND * known);
        moved.abs() > least || (band - known).abs() > least
    }
}

/// Returns a model whose permanent field has drifted for the usual time (docs/science.md, table of
/// (9)), without later observations.
fn drifted(model: &Model, seconds: f64) -> Model {
    let mut drifted = model.clone();
    let variance = USUAL_DRIFT_NT.powi(2) * seconds / DRIFT_S;
    if let Some(covariance) = &mut drifted.covariance {
        for part in PERMANENT {
            covariance[part][part] += variance;
        }
    }
    drifted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::ModelJson;
    use binnacle_compass::time::Timestamp;
    use binnacle_platform::ids::{CompassId, ModelId, VesselId};
    use binnacle_platform::time::Time;
    use serde_json::json;

    /// Returns a model of half a month of data, with a band of a degree.
    fn model(bx_nt: f64, constant_variance: f64) -> StoredModel {
        let mut covariance = [[0.0; 8]; 8];
        covariance[7][7] = constant_variance;
        let model = json!({
            "parameters_over_lambda": {
                "bx_nt": bx_nt, "chi13": 0.0, "by_nt": 0.0, "chi23": 0.0,
                "chi11_minus_chi22": 0.0, "chi12": 0.0, "chi21": 0.0,
            },
            "covariance": covariance,
        });
        let at = |text: &str| Time(Timestamp::parse(text).unwrap());
        StoredModel {
            vessel_id: VesselId::new(),
            id: ModelId::new(),
            compass_id: CompassId::new(),
            version: 3,
            created_at: at("2026-11-16T00:00:00Z"),
            input_hash: String::new(),
            estimator: String::new(),
            epoch_from: None,
            epoch_to: None,
            epoch_begun_by: None,
            data_from: at("2026-11-01T00:00:00Z"),
            data_until: at("2026-11-15T00:00:00Z"),
            place_at: at("2026-11-15T00:00:00Z"),
            lat: 48.0,
            lon: -6.0,
            variation_deg: -2.0,
            sent_at: None,
            foretold_by: None,
            h_nt: 20_000.0,
            z_nt: 43_000.0,
            model: ModelJson(serde_json::from_value(model).unwrap()),
        }
    }

    #[test]
    fn only_a_curve_that_changed_enough_is_an_update() {
        let known = model(2_000.0, 0.25);
        // 70 nT in 20,000 are 0.20 degrees athwart, the band is 0.98.
        assert!(!model(2_070.0, 0.25).is_update_of(&known));
        assert!(model(2_100.0, 0.25).is_update_of(&known));
        let known = model(2_000.0, 0.000_1);
        assert!(!model(2_020.0, 0.000_1).is_update_of(&known));
        assert!(model(2_050.0, 0.000_1).is_update_of(&known));
    }

    #[test]
    fn a_band_that_grew_or_shrank_is_an_update() {
        let known = model(2_000.0, 0.25);
        assert!(!model(2_000.0, 0.36).is_update_of(&known));
        assert!(model(2_000.0, 0.42).is_update_of(&known));
        assert!(model(2_000.0, 0.13).is_update_of(&known));
    }

    #[test]
    fn another_epoch_is_an_update_even_with_the_same_curve() {
        let known = model(2_000.0, 0.25);
        let mut after = known.clone();
        after.epoch_from = Some(known.data_from);
        after.epoch_begun_by = Some("lightning_or_shock".to_owned());
        assert!(after.is_update_of(&known));
    }

    #[test]
    fn a_model_three_days_younger_is_an_update() {
        let known = model(2_000.0, 0.25);
        let mut later = known.clone();
        later.version = 4;
        later.data_until = Time(known.data_until.0.plus_seconds(OLDER_S - 600.0));
        assert!(!later.is_update_of(&known));
        later.data_until = Time(known.data_until.0.plus_seconds(OLDER_S));
        assert!(later.is_update_of(&known));
        assert!(known.is_update_of(&later), "after a restored backup");
    }

    #[test]
    fn a_prediction_grows_less_certain_by_the_day_and_expires() {
        let predicted = model(2_000.0, 0.09);
        let mut fit = model(2_000.0, 0.1);
        assert!(!fit.replaces_prediction(&predicted));
        let later = |days: f64| Time(predicted.data_until.0.plus_seconds(86_400.0 * days));
        // A drift of 60 nT in 30 days is 0.17 degrees here.
        fit.data_until = later(6.0);
        assert!(!fit.replaces_prediction(&predicted));
        fit.data_until = later(20.0);
        assert!(fit.replaces_prediction(&predicted));
        let mut poor = model(2_000.0, 1.0);
        poor.data_until = later(59.0);
        assert!(!poor.replaces_prediction(&predicted));
        poor.data_until = later(61.0);
        assert!(poor.replaces_prediction(&predicted));
    }
}
