//! The JSON part of the conversation: enrolment, acknowledgement, downlink.

use crate::batch::StreamId;
use binnacle_magnetics::model::Model;
use binnacle_magnetics::time::Timestamp;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// `POST /api/v1/agents/enrol`: a one-time code, to be exchanged for a token.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnrolRequest {
    /// The code the operator was shown.
    pub code: String,
    /// The agent's own version, for the operator's list.
    pub agent_version: String,
}

/// The answer to an enrolment: everything the agent needs to send.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnrolAnswer {
    /// Bearer token; shown this once.
    pub token: String,
    /// A new stream, opened for this installation.
    pub stream: StreamId,
    /// The vessel's name, for the local page.
    pub vessel_name: String,
    /// The compass's name, for the local page.
    pub compass_name: String,
    /// The shore's clock.
    pub server_time: Timestamp,
}

/// `POST /api/v1/streams` with the agent's token: opens a new stream for the
/// same compass, as an agent does whose spool was lost or restored from an old
/// copy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OpenStreamAnswer {
    /// The new stream.
    pub stream: StreamId,
}

/// The answer to `PUT /api/v1/streams/{stream}/batches/{seq}`, and to
/// `GET /api/v1/streams/{stream}/downlink`.
///
/// Both take `?model={id}&settings={version}`: what the agent already has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Downlink {
    /// Every batch up to and including this one is durable on shore; 0 for none.
    pub contiguous_seq: u64,
    /// The current model, when it is not the one the agent has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelDownlink>,
    /// The current settings, when they are not those the agent has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settings: Option<Settings>,
    /// The shore's clock.
    pub server_time: Timestamp,
}

/// A model as it is sent to the bridge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelDownlink {
    /// The model version's id.
    pub id: Uuid,
    /// Counts the compass's models from 1.
    pub version: u32,
    /// The time of the last sample that went into it: its age counts from here.
    pub data_until: Timestamp,
    /// The fit itself.
    pub model: Model,
}

/// What the shore decides about how an agent samples and sends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Rises with every change; 0 is the agent's built-in default.
    pub version: u32,
    /// Speed over ground below which nothing is sampled, knots.
    pub min_sog_kn: f64,
    /// Rate of turn above which a window is refused, degrees a minute.
    pub max_rate_of_turn_deg_min: f64,
    /// Seconds after a turn in which nothing is sampled (Gaussian error).
    pub settle_s: u32,
    /// How far heading may swing to either side within 30 s, degrees.
    pub max_swing_deg: f64,
    /// The longest stretch that one sample is the mean of, seconds.
    pub sample_s: u32,
    /// A batch is sealed when its first sample is this old, seconds of ship time.
    pub seal_s: u32,
}

impl Default for Settings {
    /// Three minutes outlast the Gaussian error; the swing limit is the source paper's.
    fn default() -> Settings {
        Settings {
            version: 0,
            min_sog_kn: 4.0,
            max_rate_of_turn_deg_min: 18.0,
            settle_s: 180,
            max_swing_deg: 2.0,
            sample_s: 600,
            seal_s: 6 * 3600,
        }
    }
}
