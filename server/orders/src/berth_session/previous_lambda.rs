//! Estimate of λ from the compass's last adjustment. One heading cannot separate λ from a change
//! of the ship's magnetism along the needle.
//!
//! Invariants: it is calculated from the signed record. It is not used after work on the hull or
//! at the compass.

use crate::work_orders::payload::plan_basis::PreviousBerth;
use binnacle_adjustment::adjust::{
    Adjustment, Circumstances, EarlierLambda, Limits, ReadingForm, Water,
};
use binnacle_adjustment::binnacle::Binnacle;
use binnacle_compass::angle::Variation;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use binnacle_platform::app::App;
use binnacle_platform::db::row;
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, VesselId};
use serde::Deserialize;

/// Fields of a record from which λ follows.
#[derive(Deserialize)]
struct RecordedAdjustment {
    reading: ReadingForm,
    model_before: Model,
    earth_at_berth: Earth,
    binnacle_before: Before,
    waters: Vec<Water>,
}

#[derive(Deserialize)]
struct Earth {
    variation_deg: f64,
    h_nt: f64,
    z_nt: f64,
}

#[derive(Deserialize)]
struct Before {
    binnacle: Binnacle,
}

/// Returns λ of the compass's last completed adjustment; `None` without one, or after a change of
/// iron near the compass.
///
/// # Errors
/// Fails when the database fails.
pub(crate) async fn find_for_compass(
    app: &App,
    vessel: VesselId,
    compass: CompassId,
    now: Timestamp,
    logbook: &[LogbookEntry],
) -> Result<Option<PreviousBerth>> {
    let found = row!(
        &app.db,
        (Option<String>,),
        "SELECT record FROM work_orders
         WHERE vessel_id = $1 AND compass_id = $2 AND completed_at IS NOT NULL
         ORDER BY completed_at DESC, id DESC
         LIMIT 1",
        vessel,
        compass
    )?;
    let Some(record) = found.and_then(|(record,)| record) else {
        return Ok(None);
    };
    // An early record lacks some of these fields.
    let Ok(recorded) = serde_json::from_str::<RecordedAdjustment>(&record) else {
        return Ok(None);
    };
    let since = recorded.reading.at;
    let is_other_iron = logbook.iter().any(|entry| {
        changes_iron(entry.kind) && entry.from <= now && entry.to.unwrap_or(entry.from) >= since
    });
    Ok(if is_other_iron {
        None
    } else {
        recorded.estimate()
    })
}

/// Returns whether such work may change λ.
fn changes_iron(kind: LogbookKind) -> bool {
    matches!(
        kind,
        LogbookKind::CompassMoved
            | LogbookKind::Repair
            | LogbookKind::DryDocking
            | LogbookKind::Welding
    )
}

impl RecordedAdjustment {
    fn estimate(&self) -> Option<PreviousBerth> {
        let variation = Variation::try_from(self.earth_at_berth.variation_deg).ok()?;
        let binnacle = &self.binnacle_before.binnacle;
        let adjustment = Adjustment {
            model: &self.model_before,
            earth: EarthField {
                h_nt: self.earth_at_berth.h_nt,
                z_nt: self.earth_at_berth.z_nt,
            },
            reading: &self.reading.reading(variation).ok()?,
            scale_sd: self.reading.scale_sd(),
            compass_deg: None,
            vertical: None,
            binnacle,
            now: None,
            waters: &self.waters,
            circumstances: Circumstances::default(),
            limits: Limits::default(),
        };
        Some(PreviousBerth {
            lambda: EarlierLambda::from_berth(self.reading.at, &adjustment).ok()??,
            setting: binnacle.setting.clone(),
        })
    }
}
