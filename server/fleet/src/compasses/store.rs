//! Compasses in the database.

use super::{Compass, Role};
use binnacle_platform::db::{Db, Result, Tx, execute, row, rows};
use binnacle_platform::ids::{CompassId, OperatorId, VesselId};
use binnacle_platform::time::Time;

/// Lists a vessel's compasses in the order of entry.
pub async fn of_vessel(db: &Db, vessel: VesselId) -> Result<Vec<Compass>> {
    rows!(
        db,
        Compass,
        "SELECT id, vessel_id, name, role, make, serial_number, binnacle, created_at
         FROM compasses
         WHERE vessel_id = $1
         ORDER BY id",
        vessel
    )
}

/// Lists the compasses of an operator's vessels in a range of ids.
pub async fn of_fleet(
    db: &Db,
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
) -> Result<Vec<Compass>> {
    rows!(
        db,
        Compass,
        "SELECT c.id, c.vessel_id, c.name, c.role, c.make, c.serial_number, c.binnacle, c.created_at
         FROM compasses c
         JOIN vessels v ON v.id = c.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
         ORDER BY c.vessel_id, c.id",
        operator,
        first,
        last
    )
}

pub(super) async fn insert(tx: &mut Tx, compass: &Compass) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO compasses (vessel_id, id, name, role, make, serial_number, binnacle,
                                created_at)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8)",
        compass.vessel_id,
        compass.id,
        compass.name.as_str(),
        compass.role,
        compass.make.as_deref(),
        compass.serial_number.as_deref(),
        compass.binnacle.as_deref(),
        compass.created_at
    )?;
    Ok(())
}

/// Lists the ids of a vessel's compasses, within a transaction.
pub async fn ids(tx: &mut Tx, vessel: VesselId) -> Result<Vec<CompassId>> {
    let found: Vec<(CompassId,)> = rows!(
        in tx,
        (CompassId,),
        "SELECT id FROM compasses WHERE vessel_id = $1 ORDER BY id",
        vessel
    )?;
    Ok(found.into_iter().map(|(id,)| id).collect())
}

/// Inserts the standard compass that every vessel begins with.
pub async fn insert_standard(tx: &mut Tx, vessel: VesselId, now: Time) -> Result<()> {
    let compass = Compass {
        id: CompassId::new(),
        vessel_id: vessel,
        name: "Standard compass".to_owned(),
        role: Role::Standard,
        make: None,
        serial_number: None,
        binnacle: None,
        created_at: now,
    };
    insert(tx, &compass).await
}

/// Locks a compass of the vessel for a change, and returns it.
pub(super) async fn lock(tx: &mut Tx, vessel: VesselId, id: CompassId) -> Result<Option<Compass>> {
    row!(
        in tx,
        Compass,
        "UPDATE compasses SET name = name
         WHERE vessel_id = $1 AND id = $2
         RETURNING id, vessel_id, name, role, make, serial_number, binnacle, created_at",
        vessel,
        id
    )
}

/// Overwrites a compass's record.
pub(super) async fn update(tx: &mut Tx, compass: &Compass) -> Result<()> {
    execute!(
        tx,
        "UPDATE compasses
         SET name = $3, role = $4, make = $5, serial_number = $6, binnacle = $7
         WHERE vessel_id = $1 AND id = $2",
        compass.vessel_id,
        compass.id,
        compass.name.as_str(),
        compass.role,
        compass.make.as_deref(),
        compass.serial_number.as_deref(),
        compass.binnacle.as_deref()
    )?;
    Ok(())
}
