//! Readings within a passing disturbance: where the ship was, and the greatest error of her compass.

use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::result::{Cause, Change, Epoch, SampleReason};

/// Records in a change of what passes by where the ship was, and the greatest departure from her
/// model.
pub(crate) fn record_disturbed(change: &mut Change, readings: &[Reading], epochs: &[Epoch]) {
    let is_gnss = change.cause == Cause::GnssInterference;
    if !(change.cause.is_transient() || is_gnss) {
        return;
    }
    let within = |r: &&Reading| {
        let time = r.sample().time;
        change.from <= time && change.ended.is_none_or(|last| time <= last)
    };
    let is_disturbed = |r: &&Reading| match r.diagnostic.reason {
        Some(SampleReason::GnssInterference) => is_gnss,
        Some(SampleReason::Disturbance) => !is_gnss,
        _ => change.is_weak_transient(),
    };
    let begin = readings.partition_point(|r| r.sample().time < change.from);
    let during = readings[begin..].iter().take_while(within);
    let disturbed: Vec<&Reading> = during.filter(is_disturbed).collect();
    let middle = disturbed.get(disturbed.len() / 2);
    change.position = middle.map(|r| r.sample().position);
    if !is_gnss {
        let departed = disturbed.iter().filter_map(|r| departed_deg(r, epochs));
        change.disturbed_deg = departed.reduce(f64::max);
    }
}

fn departed_deg(reading: &Reading, epochs: &[Epoch]) -> Option<f64> {
    let time = reading.sample().time;
    let mut begun = epochs.iter().rev();
    let epoch = begun.find(|epoch| epoch.from.is_none_or(|from| from <= time))?;
    let expected = epoch.model.as_ref()?;
    let expected = expected
        .deviation(reading.sample().compass, reading.earth?)
        .ok()?;
    let measured_deg = reading.diagnostic.deviation_deg?;
    Some(wrap_180(measured_deg - expected.deviation.degrees_east()).abs())
}
