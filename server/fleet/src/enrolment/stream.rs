//! Streams of a vessel's agents, with the state of their links.

use binnacle_platform::ids::{AgentId, CompassId};
use binnacle_platform::time::Time;
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;
use uuid::Uuid;

/// A stream: one compass as one installation of the agent reports it.
#[derive(Debug, Serialize, ToSchema)]
pub struct AgentStream {
    /// The stream's id.
    pub stream: Uuid,
    /// The installation, which may have opened several streams.
    pub agent_id: AgentId,
    /// Time at which its token was revoked.
    #[schema(required)]
    pub revoked_at: Option<Time>,
    /// The compass.
    pub compass_id: CompassId,
    /// Its name.
    pub compass_name: String,
    /// The agent's version when it was enrolled.
    pub agent_version: String,
    /// Time at which the stream was opened.
    pub opened_at: Time,
    /// Time of its last batch.
    #[schema(required)]
    pub last_upload_at: Option<Time>,
    /// Every batch up to this one is stored.
    pub contiguous_seq: i64,
    /// Batches here.
    pub batches: i64,
    /// Samples in them.
    pub samples: i64,
    /// Ten-second windows by outcome: `accepted`, or why they were refused; `thinned` are
    /// those that were accepted and then left out by thinning.
    pub tally: BTreeMap<String, u64>,
    /// Link statistics of the last week.
    pub last_week: LinkWeek,
    /// State on board as the agent last reported it with a batch; none before.
    #[schema(required)]
    #[serde(rename = "aboard")]
    pub on_board: Option<BoardStatus>,
}

/// State of an agent's spool and budget, reported with a batch.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = AgentAboard)]
pub struct BoardStatus {
    /// Batches that waited on board besides the one that was sent.
    pub batches_waiting: i64,
    /// Rest of the link's budget where that is less than a day's, in hundredths of a day's,
    /// negative when overdrawn. None where there is enough, or no limit.
    #[schema(required)]
    pub budget_left_percent: Option<i64>,
    /// Time of the report.
    pub at: Time,
}

/// Statistics of a stream's link in the last seven days.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct LinkWeek {
    /// Batches received.
    pub batches: i64,
    /// Bytes in them, without the overhead of the protocols below.
    #[serde(rename = "octets")]
    pub bytes: i64,
    /// Longest delay of the latest sample of a batch, seconds: time for which it waited for the
    /// link. None without samples.
    #[schema(required)]
    pub longest_wait_s: Option<i64>,
}
