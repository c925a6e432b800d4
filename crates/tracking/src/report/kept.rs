//! Records of a voyage, and the forms in which they are kept.

use crate::state_space::ship_state::ShipState;
use binnacle_analysis::readings::reading::{Reading, readings};
use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading};
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::position::Position;
use binnacle_compass::result::SampleReason;
use binnacle_compass::sample::{Sample, SourceId};
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Shortest slot, microseconds: an hour, within which rows share their slow errors.
const SLOT_MICROS: i64 = 3600 * 1_000_000;
/// Greatest number of readings: several for each unknown of the checks in every sea of a year.
const ENOUGH: usize = 256;

/// Sample with the reason against its use that its own part of the voyage gave.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct KeptReading {
    #[serde(with = "KeptSample")]
    pub(super) sample: Sample,
    pub(super) reason: Option<SampleReason>,
}

impl KeptReading {
    pub(super) fn of(reading: &Reading) -> KeptReading {
        KeptReading {
            sample: *reading.sample(),
            reason: reading.diagnostic.reason,
        }
    }
}

/// Settled reading with its outcome.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct SettledReading {
    kept: KeptReading,
    deviation_deg: Option<f64>,
}

impl SettledReading {
    pub(super) fn of(reading: &Reading) -> SettledReading {
        SettledReading {
            kept: KeptReading::of(reading),
            deviation_deg: reading.diagnostic.deviation_deg,
        }
    }

    pub(super) fn time(&self) -> Timestamp {
        self.kept.sample.time
    }
}

/// Returns settled readings as they were.
pub(super) fn settled_readings(
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
pub(super) fn keep_some<T>(items: &mut Vec<T>, time: impl Fn(&T) -> Timestamp) {
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

/// Returns true if a reading with an outcome is offered to the model.
pub(super) fn is_offered(outcome: Option<SampleReason>) -> bool {
    matches!(
        outcome,
        None | Some(SampleReason::Outlier | SampleReason::NoModel)
    )
}

/// Row that was read.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(crate) struct TrackedRow {
    /// Place among the readings that are kept.
    pub(super) place: usize,
    /// Innovation, degrees, and its square in standard deviations.
    pub(super) innovation_deg: f32,
    pub(super) z_squared: f32,
    /// True if the vessel was in port since the row before.
    pub(super) after_port: bool,
}

/// Work on ship or compass by the logbook.
#[derive(Serialize, Deserialize)]
pub(crate) struct LoggedWork {
    pub(super) at: Timestamp,
    pub(super) kind: LogbookKind,
    /// Ship until then; none before the first row.
    pub(super) ship_before: Option<ShipState>,
}

/// Form of a sample: all values in their order.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Sample")]
struct KeptSample {
    #[serde(with = "micros")]
    time: Timestamp,
    position: Position,
    compass: CompassHeading,
    gyro: Option<TrueHeading>,
    satellite: Option<TrueHeading>,
    sog_kn: Option<f64>,
    rate_of_turn_deg_min: Option<f64>,
    spread_deg: Option<f64>,
    windows: u16,
    cog: Option<CourseOverGround>,
    roll_deg: Option<f64>,
    roll_spread_deg: Option<f64>,
    temperature_c: Option<f64>,
    gyro_source: Option<SourceId>,
    satellite_source: Option<SourceId>,
    position_reckoned: bool,
}

/// Time as a number.
pub(super) mod micros {
    use binnacle_compass::time::Timestamp;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    // By reference, as serde calls it.
    #[allow(clippy::trivially_copy_pass_by_ref)]
    pub(in crate::report) fn serialize<S: Serializer>(
        time: &Timestamp,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        time.micros().serialize(to)
    }

    pub(in crate::report) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Timestamp, D::Error> {
        Timestamp::from_micros(i64::deserialize(from)?).map_err(D::Error::custom)
    }
}

/// Result as the JSON that it is printed as.
pub(super) mod json {
    use serde::de::{DeserializeOwned, Error as _};
    use serde::ser::Error as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in crate::report) fn serialize<T: Serialize, S: Serializer>(
        result: &T,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        let text = serde_json::to_string(result).map_err(S::Error::custom)?;
        text.serialize(to)
    }

    pub(in crate::report) fn deserialize<'de, T: DeserializeOwned, D: Deserializer<'de>>(
        from: D,
    ) -> Result<T, D::Error> {
        serde_json::from_str(&String::deserialize(from)?).map_err(D::Error::custom)
    }
}
