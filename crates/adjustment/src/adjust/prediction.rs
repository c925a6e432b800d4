//! Predicted deviations for a setting, with their bands.

use super::inputs::{AdjustError, Adjustment, Water};
use super::state::MagneticState;
use crate::binnacle::Setting;
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::deviation::DeviationError;
use binnacle_compass::model::Model;
use serde::{Deserialize, Serialize};

/// Prediction on one compass heading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct PredictedRow {
    /// Compass heading, degrees.
    pub compass_deg: f64,
    /// Deviation, degrees, east positive.
    pub deviation_deg: f64,
    /// Half the width of the 95 % band, degrees.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub band95_deg: Option<f64>,
}

/// Predictions on all headings at one place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct PredictedTable {
    /// Name of the place: `berth`, or the name of a water.
    pub place: String,
    /// Horizontal field, nT.
    pub h_nt: f64,
    /// Vertical field, nT, down positive.
    pub z_nt: f64,
    /// Predictions every 15° of compass heading; empty where headings are ambiguous.
    pub rows: Vec<PredictedRow>,
    /// Greatest deviation on any heading, degrees; none where headings are ambiguous.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub worst_deg: Option<f64>,
    /// Compass heading of the greatest deviation.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub worst_compass_deg: Option<f64>,
    /// Greatest deviation with its band on any heading, degrees.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub reach_deg: Option<f64>,
    /// Widest band on any heading, degrees.
    #[cfg_attr(feature = "openapi", schema(required))]
    pub widest_band_deg: Option<f64>,
}

/// Number of evaluated headings: every 3°.
const HEADINGS: u16 = 120;
/// Evaluated headings per row: 15°.
const ROW: usize = 5;

/// Predicts the deviations at the berth and in each water.
pub(crate) fn tables(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    setting: &Setting,
) -> Result<Vec<PredictedTable>, AdjustError> {
    tables_by(adjustment, &state.model_with(setting)?)
}

/// Predicts the deviations with a model.
pub(crate) fn tables_by(
    adjustment: &Adjustment<'_>,
    model: &Model,
) -> Result<Vec<PredictedTable>, AdjustError> {
    let berth = Water {
        name: "berth".to_owned(),
        h_nt: adjustment.earth.h_nt,
        z_nt: adjustment.earth.z_nt,
        weight: 0.0,
    };
    let places = std::iter::once(&berth).chain(adjustment.waters);
    let tables = places.map(|water| {
        let rows: Result<Vec<PredictedRow>, DeviationError> = (0..HEADINGS)
            .map(|index| {
                let compass_deg = f64::from(index) * 360.0 / f64::from(HEADINGS);
                let compass =
                    CompassHeading::new(compass_deg).expect("a few steps of 3 degrees are finite");
                let predicted = model.deviation(compass, water.earth())?;
                Ok(PredictedRow {
                    compass_deg,
                    deviation_deg: predicted.deviation.degrees_east(),
                    band95_deg: predicted.band95_deg,
                })
            })
            .collect();
        match rows {
            Ok(rows) => Ok(table(water, &rows)),
            Err(DeviationError::Ambiguous { .. }) => Ok(table(water, &[])),
            Err(error) => Err(AdjustError::from(error)),
        }
    });
    tables.collect()
}

fn table(water: &Water, rows: &[PredictedRow]) -> PredictedTable {
    let worst = rows
        .iter()
        .max_by(|a, b| a.deviation_deg.abs().total_cmp(&b.deviation_deg.abs()));
    let bands = rows.iter().filter_map(|row| row.band95_deg);
    let reach = rows
        .iter()
        .map(|row| row.deviation_deg.abs() + row.band95_deg.unwrap_or(0.0));
    PredictedTable {
        place: water.name.clone(),
        h_nt: water.h_nt,
        z_nt: water.z_nt,
        rows: rows.iter().copied().step_by(ROW).collect(),
        worst_deg: worst.map(|row| row.deviation_deg.abs()),
        worst_compass_deg: worst.map(|row| row.compass_deg),
        reach_deg: reach.reduce(f64::max),
        widest_band_deg: bands.reduce(f64::max),
    }
}

/// Selects the tables to which limits apply.
pub(crate) fn counted<'a>(
    after: &'a [PredictedTable],
    waters: &'a [Water],
) -> impl Iterator<Item = &'a PredictedTable> {
    // The first table is for the berth, which always counts; a water without weight does
    // not.
    let weights = waters.iter().map(|water| water.weight);
    let counts = std::iter::once(true).chain(weights.map(|weight| weight > 0.0));
    after
        .iter()
        .zip(counts)
        .filter_map(|(table, counts)| counts.then_some(table))
}

/// Assumed residual of a water with ambiguous headings, degrees.
const AMBIGUOUS_DEG: f64 = 90.0;

/// Returns the worst residual, weighted over the waters as in the search, degrees.
pub(crate) fn weighted_worst_deg(waters: &[Water], after: &[PredictedTable]) -> f64 {
    // The first table is for the berth.
    let in_waters = waters.iter().zip(after.iter().skip(1));
    let (weights, sum) = in_waters.fold((0.0, 0.0), |(weights, sum), (water, table)| {
        let worst_deg = table.worst_deg.unwrap_or(AMBIGUOUS_DEG);
        (weights + water.weight, sum + water.weight * worst_deg)
    });
    sum / weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adjust::tests::case;

    /// The search minimises the mean over the waters; the limit applies to the worst of
    /// them.
    #[test]
    fn the_mean_over_the_waters_is_not_the_worst_of_them() {
        let case = case(60.0);
        let mut after = case.plan().plans.remove(0).after;
        for (table, worst_deg) in after.iter_mut().zip([9.0, 1.0, 4.0]) {
            table.worst_deg = Some(worst_deg);
        }
        // Two parts of the time in the first water, one in the second; the berth has no
        // weight.
        let mean_deg = weighted_worst_deg(&case.waters, &after);
        assert!((mean_deg - 2.0).abs() < 1e-12, "{mean_deg}");
        after[2].worst_deg = None;
        let mean_deg = weighted_worst_deg(&case.waters, &after);
        assert!(
            (mean_deg - (2.0 + AMBIGUOUS_DEG) / 3.0).abs() < 1e-12,
            "{mean_deg}"
        );
    }
}
