//! Violations of the limits by a plan or an updated prediction.
//!
//! Invariants: the berth and every trading water are checked, each heading by its residual
//! with its band. For an excessive residual, the largest coefficient is named.

mod spheres;

use super::diagnosis::{Coefficient, Refusal, place_text};
use super::inputs::{Adjustment, Limits, Water};
use super::prediction::{PredictedTable, counted};
use super::state::MagneticState;
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;

/// Finds the violations of predicted residuals, with their likely reasons.
pub(crate) fn find_violations(
    adjustment: &Adjustment<'_>,
    state: &MagneticState<'_>,
    after: &[PredictedTable],
    model: &Model,
) -> Vec<Refusal> {
    let found = first_violation(after, model, &adjustment.limits, adjustment.waters);
    let is_by_band = match &found {
        Some(Refusal::BandTooWide { .. }) => true,
        Some(Refusal::ResidualTooLarge {
            worst_deg,
            limit_deg,
            ..
        }) => worst_deg <= limit_deg,
        _ => false,
    };
    let mut refusals = match found {
        Some(violation @ (Refusal::ResidualTooLarge { .. } | Refusal::BandTooWide { .. })) => {
            spheres::explain_by_lambda(adjustment, state, after, violation)
        }
        found => found.into_iter().collect(),
    };
    if let Some(what) = state.drift.unchecked_note().filter(|_| is_by_band) {
        refusals.insert(0, Refusal::UncheckedBerth { what });
    }
    refusals
}

pub(crate) fn first_violation(
    after: &[PredictedTable],
    model: &Model,
    limits: &Limits,
    waters: &[Water],
) -> Option<Refusal> {
    let mut worst = None;
    for table in counted(after, waters) {
        let place = table.place.clone();
        let (Some(reach_deg), Some(worst_deg)) = (table.reach_deg, table.worst_deg) else {
            let what = format!("compass headings are ambiguous at {}", place_text(&place));
            return Some(Refusal::AmbiguousHeadings { what });
        };
        let band_deg = table.widest_band_deg.unwrap_or(f64::INFINITY);
        let too_large = |place| Refusal::ResidualTooLarge {
            place,
            reach_deg,
            worst_deg,
            limit_deg: limits.residual_deg,
            dominant: dominant_coefficient(model, table),
        };
        if worst_deg > limits.residual_deg {
            // No band can be narrow enough for that.
            return Some(too_large(place));
        }
        if band_deg > limits.band_deg {
            worst = Some(Refusal::BandTooWide {
                place,
                band_deg,
                limit_deg: limits.band_deg,
            });
        } else if reach_deg > limits.residual_deg && worst.is_none() {
            worst = Some(too_large(place));
        }
    }
    worst
}

/// Returns the largest of the exact coefficients, with the model's constant in A.
fn dominant_coefficient(model: &Model, table: &PredictedTable) -> Coefficient {
    let earth = EarthField {
        h_nt: table.h_nt,
        z_nt: table.z_nt,
    };
    let Ok(found) = Coefficients::new(&model.parameters_at(earth), earth) else {
        return Coefficient::A;
    };
    let a = found.a + model.constant_deg.to_radians();
    let sizes = [
        (a, Coefficient::A),
        (found.b, Coefficient::B),
        (found.c, Coefficient::C),
        (found.d, Coefficient::D),
        (found.e, Coefficient::E),
    ];
    let largest = sizes
        .into_iter()
        .max_by(|x, y| x.0.abs().total_cmp(&y.0.abs()));
    largest.map_or(Coefficient::A, |(_, which)| which)
}
