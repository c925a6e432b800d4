//! The raw scenario of a file, with the position of every value.

use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

pub(super) type Number = Spanned<f64>;
pub(super) type Vector = [Number; 3];
pub(super) type Matrix = [Vector; 3];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawScenario {
    pub(super) name: String,
    pub(super) seed: Option<u64>,
    pub(super) start: Option<Spanned<String>>,
    pub(super) days: Option<Number>,
    pub(super) interval_s: Option<Number>,
    pub(super) position_interval_s: Option<Number>,
    pub(super) moored_interval_s: Option<Number>,
    pub(super) wrong_checksum_rate: Option<Number>,
    pub(super) garbage_rate: Option<Number>,
    #[serde(default)]
    pub(super) storms: Vec<RawStorm>,
    #[serde(default)]
    pub(super) anomalies: Vec<RawAnomaly>,
    pub(super) routes: BTreeMap<String, Spanned<Vec<RawPoint>>>,
    pub(super) ships: Spanned<Vec<RawShip>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawStorm {
    pub(super) day: Number,
    pub(super) hours: Number,
    pub(super) strength_nt: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawAnomaly {
    pub(super) name: String,
    pub(super) lat: Number,
    pub(super) lon: Number,
    pub(super) radius_nm: Number,
    pub(super) field_nt: Vector,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPoint {
    pub(super) lat: Number,
    pub(super) lon: Number,
    pub(super) port: Option<String>,
    pub(super) stay_h: Option<Number>,
    pub(super) wait_h: Option<Number>,
    pub(super) wait_nm: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawShip {
    pub(super) name: Spanned<String>,
    pub(super) imo_number: Option<String>,
    pub(super) call_sign: Option<String>,
    pub(super) flag: Option<String>,
    pub(super) route: Spanned<String>,
    pub(super) start_point: Option<Spanned<usize>>,
    pub(super) homeward: Option<bool>,
    pub(super) speed_kn: Number,
    pub(super) turn_deg_min: Option<Number>,
    pub(super) sea: Option<Number>,
    pub(super) list_deg: Option<Number>,
    pub(super) traffic_per_day: Option<Number>,
    pub(super) alignment_deg: Option<Number>,
    pub(super) compass: Option<RawCompass>,
    pub(super) gaussian_error_deg: Option<Number>,
    pub(super) magnetism: Spanned<RawMagnetism>,
    pub(super) gyro: Option<RawGyro>,
    pub(super) satellite: Option<RawSatellite>,
    #[serde(default)]
    pub(super) events: Vec<Spanned<RawEvent>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawMagnetism {
    pub(super) b_nt: Vector,
    pub(super) chi: Matrix,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawCompass {
    pub(super) lag_s: Option<Number>,
    pub(super) resolution_deg: Option<Number>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawGyro {
    pub(super) constant_deg: Option<Number>,
    pub(super) schuler_deg: Option<Number>,
    pub(super) slow_deg: Option<Number>,
    pub(super) speed_error_left: Option<Number>,
    pub(super) lag_s: Option<Number>,
    pub(super) resolution_deg: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSatellite {
    pub(super) alignment_deg: Option<Number>,
    pub(super) dropouts_per_day: Option<Number>,
    pub(super) talker: Option<Spanned<String>>,
    pub(super) lag_s: Option<Number>,
    pub(super) resolution_deg: Option<Number>,
}

/// One struct for all kinds: a tagged enum would lose the positions of its
/// values.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawEvent {
    pub(super) kind: Spanned<String>,
    pub(super) day: Option<Number>,
    pub(super) from_day: Option<Number>,
    pub(super) to_day: Option<Number>,
    pub(super) b_nt: Option<Vector>,
    pub(super) chi: Option<Matrix>,
    pub(super) returning: Option<Number>,
    pub(super) return_days: Option<Number>,
    pub(super) offset_deg: Option<Number>,
    pub(super) drift_deg_per_h: Option<Number>,
}
