//! Status of the agent in one value: for the local page and for `status`.

mod offline;
pub(crate) mod status_socket;
mod text;

pub(crate) use offline::offline_status;

use crate::alert::{AlertStatus, HeadingDifferenceStatus, InterferenceStatus};
use crate::corrected_heading::{CardRow, CorrectedHeading};
use crate::raw_log::RawLogStatus;
use crate::sampler::Exclusion;
use crate::spool::{BudgetAccount, SpoolStatus};
use crate::uplink::LinkStatus;
use binnacle_compass::angle::TrueHeading;
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use binnacle_input::InputStatus;
use binnacle_instruments::SourceReport;
use binnacle_wire::messages::CardWithdrawn;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use tokio::time::Instant;

/// Status of the agent, as the page shows it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Status {
    /// Version of the agent.
    pub(crate) agent_version: String,
    /// Set while an agent is running.
    pub(crate) running: bool,
    /// Age of the live values; none where the spool alone was read.
    #[serde(default)]
    pub(crate) age_s: Option<f64>,
    /// Time at which the live values were put together.
    #[serde(skip)]
    pub(crate) built_at: Option<Instant>,
    pub(crate) vessel_name: Option<String>,
    pub(crate) compass_name: Option<String>,
    /// GNSS time.
    pub(crate) ship_time: Option<Timestamp>,
    /// Fault of the receiver's time.
    #[serde(default)]
    pub(crate) clock_problem: Option<String>,
    /// Interference with the receivers of satellites, while it lasts.
    #[serde(default)]
    pub(crate) gnss_interference: Option<InterferenceStatus>,
    /// Sources that must not be used as they are configured, and why.
    #[serde(default)]
    pub(crate) source_problems: Vec<String>,
    /// Reason why samples cannot be stored.
    #[serde(default)]
    pub(crate) storage_problem: Option<String>,
    /// Position of the vessel, unless it is old.
    #[serde(default)]
    pub(crate) position: Option<Position>,
    pub(crate) heading: CorrectedHeading,
    /// Last alert of the agent itself, open or closed.
    #[serde(default)]
    pub(crate) alert: Option<AlertStatus>,
    /// Last heading-difference alarm since the agent started, open or over.
    #[serde(default)]
    pub(crate) heading_difference: Option<HeadingDifferenceStatus>,
    pub(crate) gyro_deg: Option<TrueHeading>,
    pub(crate) satellite_deg: Option<TrueHeading>,
    pub(crate) sog_kn: Option<f64>,
    pub(crate) rate_of_turn_deg_min: Option<f64>,
    pub(crate) roll_deg: Option<f64>,
    pub(crate) model: Option<ModelStatus>,
    /// Deviation on every 15° at the vessel's position.
    pub(crate) card: Vec<CardRow>,
    #[serde(rename = "hold")]
    pub(crate) exclusion: Option<Exclusion>,
    /// Ten-second windows by outcome since the agent started.
    pub(crate) windows: BTreeMap<String, u64>,
    pub(crate) inputs: Vec<InputReport>,
    /// Every source that is heard.
    #[serde(default)]
    pub(crate) sources: Vec<SourceReport>,
    pub(crate) link: LinkStatus,
    pub(crate) spool: SpoolStatus,
    /// Byte budget of the link, and its balance.
    #[serde(default)]
    pub(crate) budget: Option<BudgetAccount>,
    /// Raw log.
    #[serde(default, rename = "ring")]
    pub(crate) raw_log: Option<RawLogStatus>,
}

impl Status {
    /// Returns the status with its age.
    pub(crate) fn aged(&self, now: Instant) -> Status {
        let age = self.built_at.map(|at| now.saturating_duration_since(at));
        Status {
            age_s: age.map(|age| age.as_secs_f64()),
            ..self.clone()
        }
    }
}

/// Model in use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ModelStatus {
    pub(crate) version: u32,
    /// Time of its last sample.
    pub(crate) data_until: Timestamp,
    /// Age of its last sample, by GNSS time.
    pub(crate) age_days: Option<f64>,
    /// Reason why it is no longer valid; nothing is corrected by it then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) withdrawn: Option<CardWithdrawn>,
    /// Reason why no card from before its epoch is valid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) replaces: Option<CardWithdrawn>,
    /// Source of the true headings that it was fitted to.
    #[serde(default, skip_serializing_if = "ReferenceGrade::is_heading")]
    pub(crate) reference_grade: ReferenceGrade,
}

impl ModelStatus {
    /// Notice of a model by course over ground alone.
    pub(crate) const BY_COURSE: &str =
        "by course over ground alone: no gyro or satellite compass checks it";
}

/// State of an input; counts are since the agent started.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct InputReport {
    pub(crate) name: String,
    pub(crate) connected: bool,
    /// Reason why it is not connected.
    pub(crate) problem: Option<String>,
    pub(crate) last_heard_s_ago: Option<f64>,
    /// Parsed sentences and values, by kind.
    pub(crate) sentences: BTreeMap<String, u64>,
    /// Unused lines, by reason.
    pub(crate) rejected: BTreeMap<String, u64>,
    /// Observations dropped because the channel was full.
    pub(crate) dropped: u64,
}

impl InputReport {
    /// Converts an input's counts.
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
