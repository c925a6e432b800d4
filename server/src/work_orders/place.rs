//! Where a ship is when an order has her adjusted.
//!
//! What always holds: an order whose words mean a port is for a time at which the vessel is
//! known to be there, or at which nothing is known of where she is.

use super::change::Change;
use crate::db::{Tx, rows};
use crate::error::{Error, Result};
use crate::firms::port_meant;
use crate::ids::VesselId;
use crate::time::Time;
use binnacle_schedule::ports::Port;

/// The ports of a vessel's calls at some time.
async fn ports_of(tx: &mut Tx, vessel: VesselId, at: Time) -> Result<Vec<(String,)>> {
    Ok(rows!(
        in tx,
        (String,),
        "SELECT port FROM port_calls
         WHERE vessel_id = $1 AND withdrawn_at IS NULL AND eta <= $2 AND etd >= $2
         ORDER BY eta, id",
        vessel,
        at
    )?)
}

/// Refuses a time at which the vessel is known to be at another port than an order's.
///
/// # Errors
/// [`Error::Invalid`], of a field.
pub(super) async fn must_be_there(
    change: &mut Change<'_>,
    at: Time,
    field: &'static str,
) -> Result<()> {
    let (vessel, port) = (change.whole.summary.vessel_id, &change.whole.summary.port);
    let Some(meant) = port_meant(port) else {
        return Ok(());
    };
    let there = ports_of(&mut change.tx, vessel, at).await?;
    let there: Vec<&Port> = there
        .iter()
        .filter_map(|(code,)| port_meant(code))
        .collect();
    let Some(other) = there.first() else {
        return Ok(());
    };
    if there.iter().any(|port| port.code == meant.code) {
        return Ok(());
    }
    let detail = format!(
        "by her port calls she is at {} ({}) then, not at {} ({})",
        other.name, other.code, meant.name, meant.code
    );
    Err(Error::Invalid { field, detail })
}
