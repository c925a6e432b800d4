//! Check of an order's time against the vessel's port calls.
//!
//! Invariant: an order that names a port is planned for a day on which the vessel is known to be
//! there, unless neither a coming call there nor another port at that time is known.

use crate::firms::named_port;
use crate::work_orders::order_update::Change;
use crate::work_orders::payload::hours::Hours;
use crate::work_orders::payload::port_call::{Alongside, CallFit};
use binnacle_platform::db::{Tx, rows};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::VesselId;
use binnacle_platform::time::Time;
use binnacle_schedule::ports::{Port, PortCode};

/// Ports of a vessel's calls at a time.
async fn ports_at(tx: &mut Tx, vessel: VesselId, at: Time) -> Result<Vec<(String,)>> {
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

/// Calls of a vessel at a port that are not past.
async fn coming_calls(
    tx: &mut Tx,
    vessel: VesselId,
    port: PortCode,
    now: Time,
) -> Result<Vec<Alongside>> {
    let calls = rows!(
        in tx,
        (Time, Time),
        "SELECT eta, etd FROM port_calls
         WHERE vessel_id = $1 AND withdrawn_at IS NULL AND port = $2 AND etd > $3
         ORDER BY eta, id",
        vessel,
        port.to_string(),
        now
    )?;
    let calls = calls.into_iter();
    Ok(calls
        .map(|(eta, etd)| Alongside::new(port, eta, etd))
        .collect())
}

/// Refuses a time at which the vessel is at another port than the order's, and a day without a
/// call at its port if calls there are known.
///
/// # Errors
/// [`Error::Invalid`], for a field.
pub(crate) async fn require_vessel_in_port(
    change: &mut Change<'_>,
    hours: Hours,
    field: &'static str,
) -> Result<()> {
    let at = hours.from;
    let (vessel, port) = (change.stored.summary.vessel_id, &change.stored.summary.port);
    let Some(named) = named_port(port) else {
        return Ok(());
    };
    let there = ports_at(&mut change.tx, vessel, at).await?;
    let there: Vec<&Port> = there
        .iter()
        .filter_map(|(code,)| named_port(code))
        .collect();
    let Some(other) = there.first() else {
        return require_port_call(change, named, hours, field).await;
    };
    if there.iter().any(|port| port.code == named.code) {
        return Ok(());
    }
    let detail = format!(
        "by its port calls the vessel is at {} ({}) then, not at {} ({})",
        other.name, other.code, named.name, named.code
    );
    Err(Error::Invalid { field, detail })
}

async fn require_port_call(
    change: &mut Change<'_>,
    named: &Port,
    hours: Hours,
    field: &'static str,
) -> Result<()> {
    let vessel = change.stored.summary.vessel_id;
    let calls = coming_calls(&mut change.tx, vessel, named.code, change.now).await?;
    let port = named.code.to_string();
    let is_that_day =
        |call: &Alongside| matches!(call.fit(&port, hours), CallFit::Fits | CallFit::OtherHour);
    if calls.is_empty() || calls.iter().any(is_that_day) {
        return Ok(());
    }
    let there: Vec<String> = calls.iter().map(Alongside::describe).collect();
    let detail = format!(
        "by its port calls the vessel is at {} ({port}) {}, not on the day of {}: choose a time \
            in a call, or enter the missing call",
        named.name,
        there.join(", "),
        hours.from.to_the_minute()
    );
    Err(Error::Invalid { field, detail })
}
