//! Port calls, recognised by gaps between rows.

use crate::observation::Observation;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::time::Timestamp;

/// Shortest gap, and the greatest distance across it, of a port call.
const PORT_CALL_MIN_S: f64 = 3.0 * 3600.0;
const PORT_CALL_MAX_NM: f64 = 40.0;

/// Returns true if a port call precedes the row; none where that is unknown.
pub(crate) fn follows_port_call(observations: &[Observation], row: usize) -> Option<bool> {
    let (a, b) = (&observations[row.checked_sub(1)?], &observations[row]);
    let gap_s = b.time?.seconds_since(a.time?);
    let (a, b) = (a.position?, b.position?);
    let north = a.lat_deg() - b.lat_deg();
    let east = wrap_180(a.lon_deg() - b.lon_deg()) * a.lat_deg().to_radians().cos();
    Some(gap_s > PORT_CALL_MIN_S && 60.0 * north.hypot(east) < PORT_CALL_MAX_NM)
}

/// Returns the number of rows after a time, of rows in order of time.
pub(crate) fn rows_since(rows: &[Observation], time: Timestamp) -> usize {
    let before = rows.partition_point(|row| row.time.is_none_or(|row| row <= time));
    rows.len() - before
}
