//! Epochs and findings of a timeline in the database.

use crate::analysis::Findings;
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::model::Model;
use binnacle_compass::result::{Cause, FitError};
use binnacle_compass::time::Timestamp;
use binnacle_platform::db::{Db, row, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use serde::Deserialize;

/// Last analysis of a compass, as far as it concerns changes.
pub(super) struct Analysed {
    pub(super) at: Time,
    pub(super) epochs: Vec<StoredEpoch>,
    pub(super) findings: Findings,
}

/// A stored epoch. Fields that an older server did not store are none.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct StoredEpoch {
    pub(super) from: Option<Timestamp>,
    pub(super) to: Option<Timestamp>,
    pub(super) begun_by: Option<LogbookKind>,
    pub(super) begun_by_change: Option<Cause>,
    pub(super) resumes: Option<usize>,
    pub(super) data_from: Option<Timestamp>,
    pub(super) data_until: Option<Timestamp>,
    pub(super) model: Option<Model>,
    pub(super) refusal: Option<FitError>,
}

/// A model version, and the time of the last sample in it.
#[derive(Clone, Copy, Debug, sqlx::FromRow)]
pub(super) struct Version {
    pub(super) version: i64,
    pub(super) data_until: Time,
}

/// Finds the compass's last analysis; none before the first.
pub(super) async fn find(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<Analysed>> {
    let found = row!(
        db,
        (Time, String, Option<String>),
        "SELECT analysed_at, epochs, findings FROM analyses
         WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY compass_id",
        vessel,
        compass
    )?;
    let Some((at, epochs, findings)) = found else {
        return Ok(None);
    };
    Ok(Some(Analysed {
        at,
        epochs: serde_json::from_str(&epochs)?,
        findings: findings
            .map(|findings| serde_json::from_str(&findings))
            .transpose()?
            .unwrap_or_default(),
    }))
}

/// Lists all versions of the compass's model, the oldest first.
pub(super) async fn versions(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Vec<Version>> {
    Ok(rows!(
        db,
        Version,
        "SELECT version, data_until FROM models
         WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY version",
        vessel,
        compass
    )?)
}
