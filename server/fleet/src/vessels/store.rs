//! Vessels in the database.

use super::{LastPosition, NewVessel};
use binnacle_platform::db::{Db, Result, Tx, execute, row, rows};
use binnacle_platform::error::{self, Error};
use binnacle_platform::ids::{OperatorId, VesselId};
use binnacle_platform::tenants::{OwnerOf, VesselOwner};
use binnacle_platform::time::Time;
use futures_util::future::BoxFuture;
use uuid::Uuid;

/// A vessel's own columns.
#[derive(Clone, Debug, sqlx::FromRow)]
pub struct VesselRow {
    /// The vessel's id.
    pub id: VesselId,
    /// Its name.
    pub name: String,
    /// Its IMO number.
    pub imo_number: Option<String>,
    /// Its call sign.
    pub call_sign: Option<String>,
    /// Its flag state.
    pub flag: Option<String>,
    /// State of its degaussing coils.
    pub degaussing: Option<String>,
    /// Name of its class of sister ships.
    pub sister_class: Option<String>,
    /// Time at which it was entered.
    pub created_at: Time,
    /// Time of its last batch.
    pub last_upload_at: Option<Time>,
    /// Time of its latest sample.
    pub last_sample_at: Option<Time>,
    /// Latitude of its latest sample, degrees north.
    pub last_lat: Option<f64>,
    /// Longitude of its latest sample, degrees east.
    pub last_lon: Option<f64>,
    /// Time from which it is out of service.
    pub out_of_service_at: Option<Time>,
}

impl VesselRow {
    /// Returns the place and time of its latest sample.
    pub fn last_position(&self) -> Option<LastPosition> {
        Some(LastPosition {
            lat: self.last_lat?,
            lon: self.last_lon?,
            at: self.last_sample_at?,
        })
    }
}

/// Returns the owner of a vessel.
pub fn find_owner<'a>(
    tx: &'a mut Tx,
    of: &'a OwnerOf,
) -> BoxFuture<'a, Result<Option<VesselOwner>>> {
    Box::pin(async move {
        row!(
            in tx,
            VesselOwner,
            "SELECT operator_id, name FROM vessels WHERE id = $1 ORDER BY id",
            of.0
        )
    })
}

/// Finds the operator of a vessel.
pub async fn find_operator(db: &Db, id: VesselId) -> Result<Option<OperatorId>> {
    let found = row!(
        db,
        (OperatorId,),
        "SELECT operator_id FROM vessels WHERE id = $1 ORDER BY id",
        id
    )?;
    Ok(found.map(|(operator,)| operator))
}

pub(crate) async fn list(
    db: &Db,
    operator: OperatorId,
    in_service: bool,
    after: Option<Uuid>,
    limit: i64,
) -> Result<Vec<VesselRow>> {
    rows!(
        db,
        VesselRow,
        "SELECT id, name, imo_number, call_sign, flag, degaussing, sister_class, created_at,
                last_upload_at, last_sample_at, last_lat, last_lon, out_of_service_at
         FROM vessels
         WHERE operator_id = $1 AND id > $2 AND (out_of_service_at IS NULL) = $3
         ORDER BY id
         LIMIT $4",
        operator,
        after.unwrap_or_default(),
        in_service,
        limit
    )
}

/// Finds a vessel of the operator.
pub async fn find_row(db: &Db, operator: OperatorId, id: VesselId) -> Result<Option<VesselRow>> {
    row!(
        db,
        VesselRow,
        "SELECT id, name, imo_number, call_sign, flag, degaussing, sister_class, created_at,
                last_upload_at, last_sample_at, last_lat, last_lon, out_of_service_at
         FROM vessels
         WHERE id = $2 AND operator_id = $1
         ORDER BY id",
        operator,
        id
    )
}

/// Finds a vessel of the operator's, which must exist.
///
/// # Errors
/// [`Error::NotFound`] when it does not exist or is another operator's.
pub async fn must_be_in_fleet(
    db: &Db,
    operator: OperatorId,
    id: VesselId,
) -> error::Result<VesselRow> {
    find_row(db, operator, id)
        .await?
        .ok_or(Error::NotFound("vessel"))
}

/// Vessel with the names by which a file may refer to it.
#[derive(Clone, Debug, sqlx::FromRow)]
pub struct VesselNames {
    /// The vessel's id.
    pub id: VesselId,
    /// The vessel's name.
    pub name: String,
    /// IMO number, if the vessel has one.
    pub imo_number: Option<String>,
}

/// Lists the fleet's vessels, with their names and IMO numbers.
pub async fn names(db: &Db, operator: OperatorId) -> Result<Vec<VesselNames>> {
    rows!(
        db,
        VesselNames,
        "SELECT id, name, imo_number FROM vessels WHERE operator_id = $1 ORDER BY id",
        operator
    )
}

/// Makes other entries and amendments of the operator's vessels wait for the transaction.
pub(crate) async fn lock_entries(tx: &mut Tx, operator: OperatorId) -> Result<()> {
    execute!(
        tx,
        "UPDATE operators SET name = name WHERE id = $1",
        operator
    )
    .map(drop)
}

/// Refuses an IMO number that another vessel of the operator has, after [`lock_entries`].
///
/// # Errors
/// [`Error::Invalid`] with the name of the other vessel.
pub(crate) async fn require_free_imo(
    tx: &mut Tx,
    operator: OperatorId,
    imo_number: Option<&str>,
    of: VesselId,
) -> error::Result<()> {
    let Some(number) = imo_number else {
        return Ok(());
    };
    let other = row!(
        in tx,
        (String,),
        "SELECT name FROM vessels
         WHERE operator_id = $1 AND imo_number = $2 AND id <> $3
         ORDER BY id LIMIT 1",
        operator,
        number,
        of
    )?;
    match other {
        None => Ok(()),
        Some((name,)) => Err(Error::Invalid {
            field: "imo_number",
            detail: format!("{number} is the IMO number of {name}"),
        }),
    }
}

pub(crate) async fn insert(
    tx: &mut Tx,
    operator: OperatorId,
    id: VesselId,
    new: &NewVessel,
    now: Time,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO vessels (id, operator_id, name, imo_number, call_sign, flag, degaussing,
                              sister_class, created_at)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)",
        id,
        operator,
        new.name.as_str(),
        new.imo_number.as_deref(),
        new.call_sign.as_deref(),
        new.flag.as_deref(),
        new.degaussing.as_deref(),
        new.sister_class.as_deref(),
        now
    )?;
    Ok(())
}

/// Locks a vessel for a change, and returns it.
///
/// # Errors
/// [`Error::NotFound`] when it does not exist or is another operator's.
pub(crate) async fn lock(
    tx: &mut Tx,
    operator: OperatorId,
    id: VesselId,
) -> error::Result<VesselRow> {
    let found = row!(
        in tx,
        VesselRow,
        "UPDATE vessels SET name = name
         WHERE id = $2 AND operator_id = $1
         RETURNING id, name, imo_number, call_sign, flag, degaussing, sister_class, created_at,
                   last_upload_at, last_sample_at, last_lat, last_lon, out_of_service_at",
        operator,
        id
    )?;
    found.ok_or(Error::NotFound("vessel"))
}

/// Overwrites a vessel's particulars.
pub(crate) async fn update(tx: &mut Tx, id: VesselId, amended: &NewVessel) -> Result<()> {
    execute!(
        tx,
        "UPDATE vessels SET name = $2, imo_number = $3, call_sign = $4, flag = $5, degaussing = $6,
             sister_class = $7,
             imo_shared = CASE WHEN imo_number = $3 THEN imo_shared ELSE FALSE END
         WHERE id = $1",
        id,
        amended.name.as_str(),
        amended.imo_number.as_deref(),
        amended.call_sign.as_deref(),
        amended.flag.as_deref(),
        amended.degaussing.as_deref(),
        amended.sister_class.as_deref()
    )?;
    Ok(())
}

/// Sets or clears the time from which a vessel is out of service.
pub(crate) async fn set_out_of_service(
    tx: &mut Tx,
    id: VesselId,
    since: Option<Time>,
) -> Result<()> {
    execute!(
        tx,
        "UPDATE vessels SET out_of_service_at = $2 WHERE id = $1",
        id,
        since
    )?;
    Ok(())
}

/// Tells whether a vessel is in service, within a transaction.
pub async fn is_in_service(tx: &mut Tx, id: VesselId) -> Result<bool> {
    let found = row!(
        in tx,
        (i64,),
        "SELECT COUNT(*) FROM vessels WHERE id = $1 AND out_of_service_at IS NULL",
        id
    )?;
    Ok(found.is_some_and(|(vessels,)| vessels > 0))
}
