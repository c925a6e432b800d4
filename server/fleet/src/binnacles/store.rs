//! Binnacles in the database.

use crate::compasses::Role;
use binnacle_adjustment::binnacle::Binnacle;
use binnacle_platform::db::{Db, Result as DbResult, Tx, execute, row, rows};
use binnacle_platform::error::Result;
use binnacle_platform::http::Version;
use binnacle_platform::ids::{BinnacleId, CompassId, OperatorId, VesselId};
use binnacle_platform::time::Time;
use uuid::Uuid;

/// A row of `binnacles`.
#[derive(Clone, Debug, sqlx::FromRow)]
pub struct StoredRevision {
    /// Counts from 1.
    pub revision: i64,
    /// Time of the revision.
    pub at: Time,
    /// Author of the revision.
    pub author_name: String,
    /// Reason for the revision.
    pub reason: Option<String>,
    /// The binnacle as recorded by it.
    #[sqlx(try_from = "String")]
    pub binnacle: BinnacleJson,
}

/// A binnacle as it is stored.
#[derive(Clone, Debug)]
pub struct BinnacleJson(pub Binnacle);

/// Author of a revision, and its time.
#[derive(Clone, Debug)]
pub struct Author {
    /// Their id.
    pub id: Uuid,
    /// Their name.
    pub name: String,
    /// Time of writing.
    pub at: Time,
}

impl TryFrom<String> for BinnacleJson {
    type Error = serde_json::Error;

    fn try_from(text: String) -> std::result::Result<BinnacleJson, serde_json::Error> {
        serde_json::from_str(&text).map(BinnacleJson)
    }
}

/// Returns the latest revision of a compass's binnacle; `None` before the first.
pub async fn current(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> DbResult<Option<StoredRevision>> {
    Ok(list(db, vessel, compass, None, 1).await?.pop())
}

/// Returns the latest revision of a compass's binnacle as a transaction sees it.
pub async fn current_in(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> DbResult<Option<StoredRevision>> {
    row!(
        in tx,
        StoredRevision,
        "SELECT revision, at, author_name, reason, binnacle FROM binnacles
         WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY revision DESC
         LIMIT 1",
        vessel,
        compass
    )
}

/// Makes other writers of a compass's binnacle wait for the end of a transaction.
pub async fn lock(tx: &mut Tx, vessel: VesselId, compass: CompassId) -> Result<()> {
    execute!(
        tx,
        "UPDATE compasses SET name = name WHERE vessel_id = $1 AND id = $2",
        vessel,
        compass
    )?;
    Ok(())
}

/// Returns the version of a compass's binnacle as a transaction sees it.
pub(super) async fn current_version(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Version> {
    let found = row!(
        in tx,
        (i64,),
        "SELECT revision FROM binnacles
         WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY revision DESC
         LIMIT 1",
        vessel,
        compass
    )?;
    Version::of(&found.map_or(0, |(revision,)| revision))
}

/// Lists the revisions before a given one, the newest first.
pub(super) async fn list(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    before: Option<i64>,
    limit: i64,
) -> DbResult<Vec<StoredRevision>> {
    rows!(
        db,
        StoredRevision,
        "SELECT revision, at, author_name, reason, binnacle FROM binnacles
         WHERE vessel_id = $1 AND compass_id = $2 AND revision < $3
         ORDER BY revision DESC
         LIMIT $4",
        vessel,
        compass,
        before.unwrap_or(i64::MAX),
        limit
    )
}

/// A compass of a fleet, with the latest revision of its binnacle.
#[derive(Debug, sqlx::FromRow)]
pub(super) struct CompassRow {
    pub(super) vessel_id: VesselId,
    pub(super) vessel_name: String,
    pub(super) compass_id: CompassId,
    pub(super) compass_name: String,
    pub(super) role: Role,
    revision: Option<i64>,
    at: Option<Time>,
    author_name: Option<String>,
    reason: Option<String>,
    binnacle: Option<String>,
}

impl CompassRow {
    /// Returns the last revision, if there is one.
    pub(super) fn revised(&self) -> Result<Option<StoredRevision>> {
        let (Some(revision), Some(at), Some(author_name), Some(text)) =
            (self.revision, self.at, &self.author_name, &self.binnacle)
        else {
            return Ok(None);
        };
        Ok(Some(StoredRevision {
            revision,
            at,
            author_name: author_name.clone(),
            reason: self.reason.clone(),
            binnacle: text.clone().try_into()?,
        }))
    }
}

/// Lists the compasses of an operator's vessels in service, beginning after an id.
pub(super) async fn of_fleet(
    db: &Db,
    operator: OperatorId,
    after: Option<Uuid>,
    limit: i64,
) -> DbResult<Vec<CompassRow>> {
    rows!(
        db,
        CompassRow,
        "SELECT v.id AS vessel_id, v.name AS vessel_name, c.id AS compass_id,
                c.name AS compass_name, c.role, b.revision, b.at, b.author_name, b.reason,
                b.binnacle
         FROM vessels v
         JOIN compasses c ON c.vessel_id = v.id
         LEFT JOIN binnacles b
           ON b.vessel_id = c.vessel_id AND b.compass_id = c.id
          AND b.revision = (SELECT MAX(l.revision) FROM binnacles l
                            WHERE l.vessel_id = c.vessel_id AND l.compass_id = c.id)
         WHERE v.operator_id = $1 AND v.out_of_service_at IS NULL AND c.id > $2
         ORDER BY c.id
         LIMIT $3",
        operator,
        after.unwrap_or(Uuid::nil()),
        limit
    )
}

/// Writes the next revision, unless it equals the last one.
pub async fn insert(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    id: BinnacleId,
    binnacle: &Binnacle,
    reason: Option<&str>,
    author: &Author,
) -> Result<()> {
    lock(tx, vessel, compass).await?;
    let last = row!(
        in &mut *tx,
        (i64, String),
        "SELECT revision, binnacle FROM binnacles
         WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY revision DESC
         LIMIT 1",
        vessel,
        compass
    )?;
    let text = serde_json::to_string(binnacle)?;
    let revision = match last {
        Some((_, last)) if last == text => return Ok(()),
        last => last.map_or(1, |(revision, _)| revision + 1),
    };
    execute!(
        tx,
        "INSERT INTO binnacles (vessel_id, compass_id, revision, id, at, author_id, author_name,
                                reason, binnacle)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)",
        vessel,
        compass,
        revision,
        id,
        author.at,
        author.id,
        author.name.as_str(),
        reason,
        text
    )?;
    Ok(())
}
