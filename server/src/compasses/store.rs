//! Compasses in the database.

use super::{Compass, Role};
use crate::db::{Db, Result, Tx, execute, rows};
use crate::ids::{CompassId, OperatorId, VesselId};
use crate::time::Time;

/// A vessel's compasses in the order in which they were entered.
pub async fn of_vessel(db: &Db, vessel: VesselId) -> Result<Vec<Compass>> {
    rows!(
        db,
        Compass,
        "SELECT id, vessel_id, name, role, created_at FROM compasses
         WHERE vessel_id = $1
         ORDER BY id",
        vessel
    )
}

/// The compasses of an operator's vessels from one id to another.
pub async fn of_fleet(
    db: &Db,
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
) -> Result<Vec<Compass>> {
    rows!(
        db,
        Compass,
        "SELECT c.id, c.vessel_id, c.name, c.role, c.created_at
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
        "INSERT INTO compasses (vessel_id, id, name, role, created_at)
         VALUES ($1, $2, $3, $4, $5)",
        compass.vessel_id,
        compass.id,
        compass.name.as_str(),
        compass.role,
        compass.created_at
    )?;
    Ok(())
}

/// The compass that every vessel begins with.
pub async fn insert_standard(tx: &mut Tx, vessel: VesselId, now: Time) -> Result<()> {
    let compass = Compass {
        id: CompassId::new(),
        vessel_id: vessel,
        name: "Standard compass".to_owned(),
        role: Role::Standard,
        created_at: now,
    };
    insert(tx, &compass).await
}
