//! Rules of the logbook: excluded samples, and reported causes.

use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::{Cause, SampleReason};
use binnacle_compass::sample::Sample;

/// Speed from which an open berth entry does not apply, knots: the vessel has sailed, and
/// nobody recorded it.
const UNDER_WAY_KN: f64 = 2.0;

/// Returns the reason for which an entry excludes a sample.
pub(super) fn exclusion_by_entry(entry: &LogbookEntry, sample: &Sample) -> Option<SampleReason> {
    let reason = exclusion_by_kind(entry.kind)?;
    let within = entry.from <= sample.time && entry.to.is_none_or(|to| sample.time <= to);
    let has_sailed = entry.kind == LogbookKind::Berth
        && entry.to.is_none()
        && sample.sog_kn.is_some_and(|sog_kn| sog_kn >= UNDER_WAY_KN);
    (within && !has_sailed).then_some(reason)
}

/// Returns the reason for which samples during such an entry are left out; none when they
/// are not.
pub(super) fn exclusion_by_kind(kind: LogbookKind) -> Option<SampleReason> {
    match kind {
        LogbookKind::MagneticCargo => Some(SampleReason::MagneticCargo),
        LogbookKind::Berth => Some(SampleReason::Berth),
        _ => None,
    }
}

/// Returns the cause that an entry reports.
pub fn reported_cause(kind: LogbookKind) -> Option<Cause> {
    match kind {
        LogbookKind::Lightning | LogbookKind::Shock => Some(Cause::LightningOrShock),
        LogbookKind::MagneticCargo => Some(Cause::MagneticCargo),
        LogbookKind::Berth => Some(Cause::BerthSteel),
        LogbookKind::Note => None,
        _ => Some(Cause::AdjustmentOrRepair),
    }
}
