//! A few settled readings of a long time, for what looks at a whole epoch at once: the checks of
//! its references.

use crate::report::kept::KeptReading;
use binnacle_analysis::readings::reading::{Reading, readings};
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Shortest slot, microseconds: an hour, within which rows share their slow errors.
const SLOT_MICROS: i64 = 3600 * 1_000_000;
/// Greatest number of readings: several for each unknown of the checks in every sea of a year.
const ENOUGH: usize = 256;

/// Settled reading with its outcome.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(crate) struct SettledReading {
    kept: KeptReading,
    deviation_deg: Option<f64>,
}

impl SettledReading {
    pub(crate) fn of(reading: &Reading) -> SettledReading {
        SettledReading {
            kept: KeptReading::of(reading),
            deviation_deg: reading.diagnostic.deviation_deg,
        }
    }

    pub(crate) fn time(&self) -> Timestamp {
        self.kept.sample.time
    }
}

/// Returns settled readings as they were.
pub(crate) fn settled_readings(
    settled: &[SettledReading],
    settings: &AnalysisSettings,
    grade: ReferenceGrade,
) -> Vec<Reading> {
    let samples: Vec<Sample> = settled.iter().map(|settled| settled.kept.sample).collect();
    let mut readings = readings(&samples, &[], settings, grade);
    for (reading, settled) in readings.iter_mut().zip(settled) {
        reading.diagnostic.reason = settled.kept.reason;
        reading.diagnostic.deviation_deg = settled.deviation_deg;
    }
    readings
}

/// Keeps the first item of each slot of time, of items in order of time. Slots are an hour,
/// doubled until there are few.
pub(crate) fn keep_some<T>(items: &mut Vec<T>, time: impl Fn(&T) -> Timestamp) {
    let mut slots = 1;
    loop {
        let slot = |item: &T| time(item).micros().div_euclid(SLOT_MICROS);
        items.retain(|item| slot(item) % slots == 0);
        items.dedup_by_key(|item| slot(item));
        if items.len() <= ENOUGH {
            return;
        }
        slots *= 2;
    }
}
