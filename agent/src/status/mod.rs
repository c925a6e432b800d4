//! How everything is, in one value: for the local page and for `status`.

mod offline;
mod text;

pub(crate) use offline::offline_status;

use crate::alert::AlertStatus;
use crate::corrected_heading::{CardRow, CorrectedHeading};
use crate::input::InputStatus;
use crate::raw_log::RawLogStatus;
use crate::sampler::Exclusion;
use crate::spool::{BudgetAccount, SpoolStatus};
use crate::uplink::LinkStatus;
use binnacle_magnetics::angle::TrueHeading;
use binnacle_magnetics::time::Timestamp;
use binnacle_wire::messages::CardWithdrawn;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Everything the page shows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Status {
    /// The agent's version.
    pub(crate) agent_version: String,
    /// Whether an agent is running: the rest is live then, else from the spool.
    pub(crate) running: bool,
    pub(crate) vessel_name: Option<String>,
    pub(crate) compass_name: Option<String>,
    /// The ship's own time.
    pub(crate) ship_time: Option<Timestamp>,
    /// What is wrong with the receiver's time.
    #[serde(default)]
    pub(crate) clock_problem: Option<String>,
    /// Why samples cannot be stored.
    #[serde(default)]
    pub(crate) storage_problem: Option<String>,
    pub(crate) heading: CorrectedHeading,
    /// The agent's last alert of its own: open, or how it ended.
    #[serde(default)]
    pub(crate) alert: Option<AlertStatus>,
    pub(crate) gyro_deg: Option<TrueHeading>,
    pub(crate) satellite_deg: Option<TrueHeading>,
    pub(crate) sog_kn: Option<f64>,
    pub(crate) rate_of_turn_deg_min: Option<f64>,
    pub(crate) roll_deg: Option<f64>,
    pub(crate) model: Option<ModelStatus>,
    /// Deviation on every 15° at the ship's place.
    pub(crate) card: Vec<CardRow>,
    #[serde(rename = "hold")]
    pub(crate) exclusion: Option<Exclusion>,
    /// Ten-second windows by outcome since the agent started.
    pub(crate) windows: BTreeMap<String, u64>,
    pub(crate) inputs: Vec<InputReport>,
    pub(crate) link: LinkStatus,
    pub(crate) spool: SpoolStatus,
    /// What the link may cost, and what is left of it.
    #[serde(default)]
    pub(crate) budget: Option<BudgetAccount>,
    /// What was said in each second, kept on board.
    #[serde(default, rename = "ring")]
    pub(crate) raw_log: Option<RawLogStatus>,
}

/// The model in use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ModelStatus {
    pub(crate) version: u32,
    /// The time of its last sample.
    pub(crate) data_until: Timestamp,
    /// Since then, by the ship's time.
    pub(crate) age_days: Option<f64>,
    /// Why it holds no more; nothing is corrected by it then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) withdrawn: Option<CardWithdrawn>,
    /// Why no card from before its epoch holds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) replaces: Option<CardWithdrawn>,
}

/// How an input is doing; counts are since the agent started.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct InputReport {
    pub(crate) name: String,
    pub(crate) connected: bool,
    /// Why it is not connected.
    pub(crate) problem: Option<String>,
    pub(crate) last_heard_s_ago: Option<f64>,
    /// Sentences and values that were understood, by kind.
    pub(crate) sentences: BTreeMap<String, u64>,
    /// Lines that were not used, by reason.
    pub(crate) rejected: BTreeMap<String, u64>,
    /// Observations for which there was no room.
    pub(crate) dropped: u64,
}

impl InputReport {
    /// An input's counts under its name.
    pub(crate) fn new(name: &str, status: InputStatus) -> InputReport {
        let owned = |counts: BTreeMap<&'static str, u64>| {
            let owned = counts.into_iter();
            owned
                .map(|(name, count)| (name.to_owned(), count))
                .collect()
        };
        InputReport {
            name: name.to_owned(),
            connected: status.connected,
            problem: status.problem,
            last_heard_s_ago: status.last_heard_s_ago,
            sentences: owned(status.sentences),
            rejected: owned(status.rejected),
            dropped: status.dropped,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_json_reads_back() {
        let status = Status::default();
        let json = serde_json::to_string(&status).unwrap();
        assert_eq!(serde_json::from_str::<Status>(&json).unwrap(), status);
    }
}
