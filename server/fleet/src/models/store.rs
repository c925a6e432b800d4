//! Model versions in the database.

use super::ModelJson;
use binnacle_platform::db::{Db, Result, Tx, execute, row, rows};
use binnacle_platform::ids::{CompassId, ModelId, OperatorId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_wire::messages::CardWithdrawn;

/// A row of `models`.
#[derive(Clone, Debug, sqlx::FromRow)]
#[allow(missing_docs, reason = "they are the columns")]
pub struct StoredModel {
    pub vessel_id: VesselId,
    pub id: ModelId,
    pub compass_id: CompassId,
    pub version: i64,
    pub created_at: Time,
    pub input_hash: String,
    pub estimator: String,
    pub epoch_from: Option<Time>,
    pub epoch_to: Option<Time>,
    pub epoch_begun_by: Option<String>,
    pub data_from: Time,
    pub data_until: Time,
    pub place_at: Time,
    pub lat: f64,
    pub lon: f64,
    pub variation_deg: f64,
    pub h_nt: f64,
    pub z_nt: f64,
    #[sqlx(try_from = "String")]
    pub model: ModelJson,
    pub foretold_by: Option<OrderId>,
    pub sent_at: Option<Time>,
}

/// Returns the current model of a compass; `None` while its card is withdrawn.
pub async fn current(db: &Db, vessel: VesselId, compass: CompassId) -> Result<Option<StoredModel>> {
    row!(
        db,
        StoredModel,
        "SELECT m.* FROM models m
         WHERE m.vessel_id = $1 AND m.compass_id = $2
           AND NOT EXISTS (SELECT 1 FROM analyses a
                           WHERE a.vessel_id = m.vessel_id AND a.compass_id = m.compass_id
                             AND a.card_withdrawn_at IS NOT NULL)
         ORDER BY m.version DESC
         LIMIT 1",
        vessel,
        compass
    )
}

/// Lists the current models of a vessel's compasses.
pub async fn current_of_vessel(db: &Db, vessel: VesselId) -> Result<Vec<StoredModel>> {
    rows!(
        db,
        StoredModel,
        "SELECT m.* FROM models m
         WHERE m.vessel_id = $1
           AND NOT EXISTS (SELECT 1 FROM analyses a
                           WHERE a.vessel_id = m.vessel_id AND a.compass_id = m.compass_id
                             AND a.card_withdrawn_at IS NOT NULL)
           AND m.version = (SELECT MAX(n.version) FROM models n
                            WHERE n.vessel_id = m.vessel_id AND n.compass_id = m.compass_id)
         ORDER BY m.compass_id",
        vessel
    )
}

/// Lists the current models of an operator's vessels in a range of ids.
pub async fn current_of_fleet(
    db: &Db,
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
) -> Result<Vec<StoredModel>> {
    rows!(
        db,
        StoredModel,
        "SELECT m.* FROM models m
         JOIN vessels v ON v.id = m.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
           AND NOT EXISTS (SELECT 1 FROM analyses a
                           WHERE a.vessel_id = m.vessel_id AND a.compass_id = m.compass_id
                             AND a.card_withdrawn_at IS NOT NULL)
           AND m.version = (SELECT MAX(n.version) FROM models n
                            WHERE n.vessel_id = m.vessel_id AND n.compass_id = m.compass_id)
         ORDER BY m.vessel_id, m.compass_id",
        operator,
        first,
        last
    )
}

/// Lists a compass's models before a version, the newest first.
pub(super) async fn list(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    before: Option<i64>,
    limit: i64,
) -> Result<Vec<StoredModel>> {
    rows!(
        db,
        StoredModel,
        "SELECT * FROM models
         WHERE vessel_id = $1 AND compass_id = $2 AND version < $3
         ORDER BY version DESC
         LIMIT $4",
        vessel,
        compass,
        before.unwrap_or(i64::MAX),
        limit
    )
}

/// Lists a compass's last models, as many as an agent that rarely calls may be behind.
pub async fn list_recent(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Vec<StoredModel>> {
    const RECENT: i64 = 32;
    list(db, vessel, compass, None, RECENT).await
}

/// Lists the models of a compass that were current at some time between two instants, the oldest
/// first: those made between them, and the last one made before.
pub async fn list_in_force(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    from: Time,
    to: Time,
) -> Result<Vec<StoredModel>> {
    rows!(
        db,
        StoredModel,
        "SELECT * FROM models
         WHERE vessel_id = $1 AND compass_id = $2 AND created_at < $4
           AND created_at >= COALESCE((SELECT MAX(created_at) FROM models
                                       WHERE vessel_id = $1 AND compass_id = $2
                                         AND created_at <= $3), $3)
         ORDER BY version",
        vessel,
        compass,
        from,
        to
    )
}

/// Finds a model of a compass by its version, or the version kept before it: nobody could notice
/// their difference.
pub async fn find_version(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    version: i64,
) -> Result<Option<StoredModel>> {
    row!(
        db,
        StoredModel,
        "SELECT * FROM models
         WHERE vessel_id = $1 AND compass_id = $2 AND version <= $3
         ORDER BY version DESC
         LIMIT 1",
        vessel,
        compass,
        version
    )
}

/// Returns the withdrawal of the compass's last card, with time and reason; none while it holds.
pub async fn card_withdrawn(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<CardWithdrawn>> {
    let found = row!(
        db,
        StoredWithdrawal,
        "SELECT card_withdrawn_at, card_withdrawn_by FROM analyses
         WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY compass_id",
        vessel,
        compass
    )?;
    Ok(found.and_then(StoredWithdrawal::read))
}

/// Does what [`card_withdrawn`] does, within a transaction.
pub async fn card_withdrawn_in(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<CardWithdrawn>> {
    let found = row!(
        in tx,
        StoredWithdrawal,
        "SELECT card_withdrawn_at, card_withdrawn_by FROM analyses
         WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY compass_id",
        vessel,
        compass
    )?;
    Ok(found.and_then(StoredWithdrawal::read))
}

/// Columns of a withdrawn card.
#[derive(sqlx::FromRow)]
struct StoredWithdrawal {
    card_withdrawn_at: Option<Time>,
    card_withdrawn_by: Option<String>,
}

impl StoredWithdrawal {
    fn read(self) -> Option<CardWithdrawn> {
        Some(CardWithdrawn {
            since: self.card_withdrawn_at?.0,
            reason: self.card_withdrawn_by?,
        })
    }
}

/// Returns the compass's highest model if an adjustment predicted it and no heading at sea
/// contradicts it.
pub async fn find_prediction(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<StoredModel>> {
    row!(
        in tx,
        StoredModel,
        "SELECT m.* FROM models m
         JOIN work_orders o ON o.vessel_id = m.vessel_id AND o.id = m.foretold_by
         WHERE m.vessel_id = $1 AND m.compass_id = $2 AND o.state <> 'failed'
           AND (o.state <> 'closed' OR o.verified_at IS NOT NULL)
           AND m.version = (SELECT MAX(n.version) FROM models n
                            WHERE n.vessel_id = m.vessel_id AND n.compass_id = m.compass_id)
         ORDER BY m.version",
        vessel,
        compass
    )
}

/// Stores the model of an analysis as the next version. The last one goes if it is kept for
/// nothing: nobody could notice its difference from the one before, and the ship never had it. Its
/// number is not used again.
pub async fn insert_analysed(tx: &mut Tx, model: &StoredModel) -> Result<()> {
    let known = rows!(
        in &mut *tx,
        StoredModel,
        "SELECT * FROM models
         WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY version DESC
         LIMIT 2",
        model.vessel_id,
        model.compass_id
    )?;
    insert(tx, model).await?;
    if let [last, before] = &known[..]
        && last.sent_at.is_none()
        && last.foretold_by.is_none()
        && !last.is_update_of(before)
    {
        execute!(
            &mut *tx,
            "DELETE FROM models WHERE vessel_id = $1 AND id = $2",
            last.vessel_id,
            last.id
        )?;
    }
    Ok(())
}

/// Notes that a model was sent to the ship.
pub async fn note_sent(tx: &mut Tx, model: &StoredModel, now: Time) -> Result<()> {
    execute!(
        tx,
        "UPDATE models SET sent_at = $3 WHERE vessel_id = $1 AND id = $2 AND sent_at IS NULL",
        model.vessel_id,
        model.id,
        now
    )?;
    Ok(())
}

/// Stores a model as the compass's next version. Ignores its `version`.
pub async fn insert(tx: &mut Tx, model: &StoredModel) -> Result<()> {
    let text = serde_json::to_string(&model.model)
        .map_err(|error| sqlx::Error::Encode(Box::new(error)))?;
    execute!(
        tx,
        "INSERT INTO models (vessel_id, id, compass_id, version, created_at, input_hash, estimator,
                             epoch_from, epoch_to, epoch_begun_by, data_from, data_until,
                             place_at, lat, lon, variation_deg, h_nt, z_nt, model,
                             foretold_by)
         SELECT $1, $2, $3, COALESCE(MAX(version), 0) + 1, $4, $5, $6, $7, $8, $9, $10, $11,
                $12, $13, $14, $15, $16, $17, $18, $19
         FROM models WHERE vessel_id = $1 AND compass_id = $3",
        model.vessel_id,
        model.id,
        model.compass_id,
        model.created_at,
        model.input_hash.as_str(),
        model.estimator.as_str(),
        model.epoch_from,
        model.epoch_to,
        model.epoch_begun_by.as_deref(),
        model.data_from,
        model.data_until,
        model.place_at,
        model.lat,
        model.lon,
        model.variation_deg,
        model.h_nt,
        model.z_nt,
        text,
        model.foretold_by
    )?;
    Ok(())
}
