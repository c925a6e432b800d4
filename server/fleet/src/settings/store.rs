//! Settings in the database.

use super::alert_limits::AlertLimits;
use super::vessel_settings::VesselSettings;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_platform::db::{Db, Tx, execute, row};
use binnacle_platform::error::Result;
use binnacle_platform::ids::VesselId;
use binnacle_platform::time::Time;
use binnacle_wire::messages::Settings;

type StoredSettings = (i64, String, String, String);

const FIND: &str = "SELECT version, agent, analysis, alerts FROM vessel_settings
     WHERE vessel_id = $1
     ORDER BY vessel_id";

/// Returns the vessel's settings, or the defaults.
pub async fn find(db: &Db, vessel: VesselId) -> Result<VesselSettings> {
    settings_of(row!(db, StoredSettings, FIND, vessel)?)
}

/// Returns the vessel's settings as a transaction sees them, or the defaults.
pub(super) async fn find_in(tx: &mut Tx, vessel: VesselId) -> Result<VesselSettings> {
    settings_of(row!(in tx, StoredSettings, FIND, vessel)?)
}

fn settings_of(stored: Option<StoredSettings>) -> Result<VesselSettings> {
    let Some((version, agent, analysis, alerts)) = stored else {
        return Ok(VesselSettings {
            agent: Settings::default(),
            analysis: AnalysisSettings::default(),
            alerts: AlertLimits::default(),
        });
    };
    let mut agent: Settings = serde_json::from_str(&agent)?;
    agent.version = u32::try_from(version).unwrap_or(u32::MAX);
    Ok(VesselSettings {
        agent,
        analysis: serde_json::from_str(&analysis)?,
        alerts: serde_json::from_str(&alerts)?,
    })
}

/// Stores a new version.
pub(super) async fn change(
    tx: &mut Tx,
    vessel: VesselId,
    settings: &VesselSettings,
    now: Time,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO vessel_settings (vessel_id, version, agent, analysis, alerts, changed_at)
         VALUES ($1, 1, $2, $3, $4, $5)
         ON CONFLICT (vessel_id) DO UPDATE
         SET version = vessel_settings.version + 1, agent = excluded.agent,
             analysis = excluded.analysis, alerts = excluded.alerts,
             changed_at = excluded.changed_at",
        vessel,
        serde_json::to_string(&settings.agent)?,
        serde_json::to_string(&settings.analysis)?,
        serde_json::to_string(&settings.alerts)?,
        now
    )?;
    Ok(())
}
