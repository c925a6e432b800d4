//! Verdict of an open alert: the suspected instrument, as readings change.

use crate::alert::record::AlertRecord;
use binnacle_compass::angle::wrap_180;
use binnacle_wire::alert::{ShipAlert, Suspect};

/// Returns whether two instruments confirm the compass, so that it may be steered by.
pub(super) fn clears_compass(suspect: Suspect) -> bool {
    matches!(suspect, Suspect::Gyro | Suspect::Satellite)
}

/// Returns whether a reference that had readings has none any more.
pub(super) fn has_lost_reference(before: &ShipAlert, updated: &ShipAlert) -> bool {
    let is_silent = |was: Option<f64>, is: Option<f64>| was.is_some() && is.is_none();
    is_silent(before.gyro_departure_deg, updated.gyro_departure_deg)
        || is_silent(
            before.satellite_departure_deg,
            updated.satellite_departure_deg,
        )
}

/// Returns the alert with new figures if they change the verdict.
///
/// A reference that falls silent takes nothing back of what it proved, as long as the other one is
/// unchanged. The compass is cleared at most once per alert. Later evidence against it holds until
/// the alert ends, because a bad reference and a compass that moves towards it look like another
/// bad reference.
pub(super) fn reassess_alert(record: &AlertRecord, updated: ShipAlert) -> Option<ShipAlert> {
    let before = &record.alert;
    let (was, is) = (before.suspect(), updated.suspect());
    if !clears_compass(was) {
        let may_be = is == Suspect::Compass || (clears_compass(is) && !record.clearance_revoked);
        return (was == Suspect::Unknown && may_be).then_some(updated);
    }
    if has_lost_reference(before, &updated) {
        let moved = |was: Option<f64>, is: Option<f64>| {
            was.zip(is)
                .is_some_and(|(was, is)| wrap_180(is - was).abs() > updated.limit_deg)
        };
        let has_moved = moved(before.gyro_departure_deg, updated.gyro_departure_deg)
            || moved(
                before.satellite_departure_deg,
                updated.satellite_departure_deg,
            );
        return has_moved.then_some(updated);
    }
    let bears_out = match was {
        Suspect::Gyro => updated.satellite_departure_deg,
        _ => updated.gyro_departure_deg,
    };
    if bears_out.is_none_or(|deg| deg.abs() <= updated.limit_deg) {
        return None;
    }
    // One reference alone clears nobody.
    Some(ShipAlert {
        satellite_departure_deg: updated
            .satellite_departure_deg
            .filter(|_| !clears_compass(is)),
        ..updated
    })
}
