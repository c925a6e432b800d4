//! Which samples the logbook excludes.

use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::{Cause, SampleReason};
use binnacle_compass::sample::Sample;

/// An open berth entry says nothing of a sample taken at this speed or more,
/// knots: she has sailed, and nobody wrote it down.
const UNDER_WAY_KN: f64 = 2.0;

/// Why a sample tells nothing of the ship alone, by this entry.
pub(super) fn excludes(entry: &LogbookEntry, sample: &Sample) -> Option<SampleReason> {
    let reason = exclusion(entry.kind)?;
    let within = entry.from <= sample.time && entry.to.is_none_or(|to| sample.time <= to);
    let has_sailed = entry.kind == LogbookKind::Berth
        && entry.to.is_none()
        && sample.sog_kn.is_some_and(|sog_kn| sog_kn >= UNDER_WAY_KN);
    (within && !has_sailed).then_some(reason)
}

/// Why samples taken during such an entry are left out; none when they are not.
pub(super) fn exclusion(kind: LogbookKind) -> Option<SampleReason> {
    match kind {
        LogbookKind::MagneticCargo => Some(SampleReason::MagneticCargo),
        LogbookKind::Berth => Some(SampleReason::Berth),
        _ => None,
    }
}

/// What an entry of the logbook is a report of.
pub(super) fn cause_of(kind: LogbookKind) -> Option<Cause> {
    match kind {
        LogbookKind::Lightning | LogbookKind::Shock => Some(Cause::LightningOrShock),
        LogbookKind::MagneticCargo => Some(Cause::MagneticCargo),
        LogbookKind::Berth => Some(Cause::BerthSteel),
        LogbookKind::Note => None,
        _ => Some(Cause::AdjustmentOrRepair),
    }
}
