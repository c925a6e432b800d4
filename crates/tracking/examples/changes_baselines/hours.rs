//! A threshold on the mean residual of an hour.

use crate::score::listen;
use crate::ship::{Hour, Ship};

/// By a threshold in degrees.
pub(crate) fn alarms(ship: &Ship, threshold: f64) -> Vec<usize> {
    let last = |hour: &&Hour| hour.last;
    listen(ship, ship.hours.iter(), last, |hour, _| {
        hour.mean_deg.abs() > threshold
    })
}
