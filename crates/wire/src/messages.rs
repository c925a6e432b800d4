//! The JSON messages: enrolment, acknowledgement, downlink, and officers'
//! reports for the logbook and azimuths.

use crate::azimuth::AzimuthReport;
use crate::batch::StreamId;
use crate::logbook::Report;
pub use crate::settings::Settings;
use binnacle_compass::model::Model;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};
use std::fmt;
use uuid::Uuid;

/// A one-time code to be exchanged for a token: the request of `POST
/// /api/v1/agents/enrol`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct EnrolRequest {
    /// The code shown to the operator.
    pub code: String,
    /// The agent's own version, for the operator's list.
    pub agent_version: String,
}

/// Everything the agent needs to send: the response to an enrolment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = EnrolAnswer))]
pub struct EnrolResponse {
    /// Bearer token; shown this once.
    pub token: String,
    /// A new stream, opened for this installation.
    #[cfg_attr(feature = "openapi", schema(value_type = Uuid))]
    pub stream: StreamId,
    /// The vessel's name, for the local page.
    pub vessel_name: String,
    /// The compass's name, for the local page.
    pub compass_name: String,
    /// The server's clock.
    pub server_time: Timestamp,
}

/// A token that is not valid yet: the response to `POST /api/v1/agents/token`,
/// and the body of `PUT /api/v1/agents/token`, which activates it in place of
/// the request's own token. An agent stores the new token before that `PUT`,
/// and keeps the old one until it has the response.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = NewAgentToken))]
pub struct NewToken {
    /// Bearer token.
    pub token: String,
}

impl fmt::Debug for NewToken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a token (withheld)")
    }
}

/// A new stream for the same compass: the response to `POST /api/v1/streams`.
///
/// An agent opens one when its spool was lost or restored from an old copy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = OpenStreamAnswer))]
pub struct OpenStreamResponse {
    /// The new stream.
    #[cfg_attr(feature = "openapi", schema(value_type = Uuid))]
    pub stream: StreamId,
}

/// Acknowledgement, and everything that the agent lacks: the response to `PUT
/// /api/v1/streams/{stream}/batches/{seq}` and to `GET
/// /api/v1/streams/{stream}/downlink`.
///
/// Both take `?model={id}&settings={version}`, the agent's current ones. A
/// model that this version of the program cannot read leaves the rest intact:
/// the server may be years ahead of an agent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(from = "Received")]
pub struct Downlink {
    /// Every batch up to and including this one is durable on the server; 0 for
    /// none.
    pub contiguous_seq: u64,
    /// The current model, when it is not the one the agent has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelDownlink>,
    /// The readable part of a model of an unknown form; never sent.
    #[serde(skip)]
    pub unread: Option<UnreadModel>,
    /// The reason why the agent's model is withdrawn, until another replaces
    /// it; absent while the model holds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub card_withdrawn: Option<CardWithdrawn>,
    /// The current settings, when they are not those the agent has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settings: Option<Settings>,
    /// The server's clock.
    pub server_time: Timestamp,
}

/// A downlink before conversion.
#[derive(Deserialize)]
#[serde(rename = "Downlink")]
struct Received {
    contiguous_seq: u64,
    #[serde(default)]
    model: Option<ReceivedModel>,
    #[serde(default)]
    card_withdrawn: Option<CardWithdrawn>,
    #[serde(default)]
    settings: Option<Settings>,
    server_time: Timestamp,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum ReceivedModel {
    Readable(Box<ModelDownlink>),
    Other(UnreadModel),
}

impl From<Received> for Downlink {
    fn from(received: Received) -> Downlink {
        let (model, unread) = match received.model {
            Some(ReceivedModel::Readable(model)) => (Some(*model), None),
            Some(ReceivedModel::Other(unread)) => (None, Some(unread)),
            None => (None, None),
        };
        Downlink {
            contiguous_seq: received.contiguous_seq,
            model,
            unread,
            card_withdrawn: received.card_withdrawn,
            settings: received.settings,
            server_time: received.server_time,
        }
    }
}

/// The readable part of a model of an unknown form.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(default)]
pub struct UnreadModel {
    /// Number of the model, counting the compass's models from 1.
    pub version: Option<u32>,
    /// The reason why no card from before its epoch holds.
    pub replaces: Option<CardWithdrawn>,
}

/// A model as sent to the bridge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ModelDownlink {
    /// The model version's id.
    pub id: Uuid,
    /// Number of the model, counting the compass's models from 1.
    pub version: u32,
    /// The time of the last sample that went into it: its age counts from here.
    pub data_until: Timestamp,
    /// The reason why no card from before its epoch holds; none in the first
    /// epoch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub replaces: Option<CardWithdrawn>,
    /// The fit.
    pub model: Model,
}

/// Withdrawal of earlier cards: the ship's magnetism or the compass changed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct CardWithdrawn {
    /// Time of the change, from which they do not hold.
    pub since: Timestamp,
    /// The cause: a kind of logbook entry, a detected cause, or
    /// `ship_as_before`. More values may be added.
    #[cfg_attr(feature = "openapi", schema(example = "adjustment"))]
    pub reason: String,
}

impl CardWithdrawn {
    /// Returns a sentence, without a full stop, on a card that replaced earlier
    /// ones.
    pub fn of_older_cards(&self) -> String {
        format!(
            "no card from before {} holds ({})",
            self.since.to_chrono().format("%Y-%m-%d %H:%M UTC"),
            self.reason.replace('_', " ")
        )
    }

    /// Advice while there is no model.
    pub const ADVICE: &str = "steer by gyro or satellite compass, take an azimuth once a watch and \
        on each new course; steady courses on other headings make a new card soonest";
}

/// A sentence without a full stop.
impl fmt::Display for CardWithdrawn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let reason = self.reason.replace('_', " ");
        write!(f, "the card has not held since {} ({reason})", self.since)
    }
}

/// An officer's report, complete, under an id made on board: the request of
/// `PUT /api/v1/agents/logbook/{id}`.
///
/// It may be sent until it is acknowledged: repeating it, or sending an older
/// revision late, changes nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = BoardReport))]
pub struct LogbookReport {
    /// Revision, from 1; rises by one with each change by the officer.
    #[cfg_attr(feature = "openapi", schema(minimum = 1))]
    pub revision: u32,
    /// The officer's name; may be empty.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(max_length = 100, default = ""))]
    pub reporter: String,
    /// True when the officer withdraws the report.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(default = false))]
    pub withdrawn: bool,
    /// The event reported.
    #[serde(flatten)]
    pub report: Report,
}

/// An officer's report in the logbook: the response to the report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = BoardReportAnswer))]
pub struct LogbookResponse {
    /// The latest revision in the logbook.
    pub revision: u32,
    /// True when the entry was withdrawn, on board or in the office.
    pub withdrawn: bool,
}

/// An azimuth observed on board, under an id made there: the request of `PUT
/// /api/v1/agents/azimuths/{id}`.
///
/// An observation never changes: a wrong one is withdrawn. It may be sent until it is
/// acknowledged: repeating it changes nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct BoardAzimuth {
    /// True when the observer withdraws it.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(default = false))]
    pub withdrawn: bool,
    /// The observation and its observer.
    #[serde(flatten)]
    pub report: AzimuthReport,
}

/// The response to a [`BoardAzimuth`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = BoardAzimuthAnswer))]
pub struct BoardAzimuthResponse {
    /// True when it was withdrawn, on board or in the office.
    pub withdrawn: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::de::DeserializeOwned;
    use serde_json::{Value, json};
    use std::fmt::Debug;

    fn assert_comes_back<M: Serialize + DeserializeOwned + PartialEq + Debug>(sent: &Value) -> M {
        let message: M = serde_json::from_value(sent.clone()).unwrap();
        assert_eq!(&serde_json::to_value(&message).unwrap(), sent);
        let text = serde_json::to_string(&message).unwrap();
        assert_eq!(serde_json::from_str::<M>(&text).unwrap(), message);
        message
    }

    const ID: &str = "01934f2a-7c00-7000-8000-00000000002a";

    #[test]
    fn an_enrolment_reads_as_it_is_written() {
        assert_comes_back::<EnrolRequest>(&json!({"code": "K7QF-2M9X", "agent_version": "0.1.0"}));
        assert_comes_back::<EnrolResponse>(&json!({
            "token": "secret",
            "stream": ID,
            "vessel_name": "Nao Victoria",
            "compass_name": "Standard compass",
            "server_time": "2026-11-21T07:00:00Z",
        }));
        assert_comes_back::<OpenStreamResponse>(&json!({ "stream": ID }));
    }

    #[test]
    fn a_report_reads_as_it_is_written() {
        assert_comes_back::<LogbookReport>(&json!({
            "revision": 2, "reporter": "Li", "withdrawn": false,
            "kind": "magnetic_cargo", "from": "2026-11-20T00:00:00Z",
            "to": "2026-11-21T00:00:00Z", "cargo": "scrap", "hatch": "2", "port": "Bilbao",
            "note": "",
        }));
        assert_comes_back::<LogbookResponse>(&json!({ "revision": 2, "withdrawn": false }));
    }

    #[test]
    fn an_azimuth_reads_as_it_is_written() {
        assert_comes_back::<BoardAzimuth>(&json!({
            "withdrawn": false, "time": "2026-11-20T10:00:00Z", "lat": 43.4, "lon": -3.1,
            "kind": "sun_azimuth", "compass_heading_deg": 92.0, "compass_bearing_deg": 150.0,
            "gyro_heading_deg": 94.0, "gyro_bearing_deg": null, "horizon": null,
            "height_of_eye_m": null, "name": null, "true_bearing_deg": null, "altitude_deg": null,
            "confirmed": false, "observer": "LW", "remark": "",
        }));
        assert_comes_back::<BoardAzimuthResponse>(&json!({ "withdrawn": true }));
    }

    #[test]
    fn a_downlink_omits_unchanged_parts() {
        let bare = json!({"contiguous_seq": 12, "server_time": "2026-11-21T07:00:00.250Z"});
        let downlink = assert_comes_back::<Downlink>(&bare);
        assert_eq!((downlink.model, downlink.settings), (None, None));
    }

    #[test]
    fn a_downlink_carries_model_and_settings_whole() {
        let parameters = json!({
            "bx_nt": 2060.0, "chi13": -0.0215, "by_nt": -2930.0, "chi23": 0.0022,
            "chi11_minus_chi22": 0.0352, "chi12": 0.0012, "chi21": 0.0016,
        });
        let sent = json!({
            "contiguous_seq": 3,
            "server_time": "2026-11-21T07:00:00Z",
            "settings": Settings::default(),
            "model": {
                "id": ID,
                "version": 4,
                "data_until": "2026-11-20T00:00:00Z",
                "model": { "parameters_over_lambda": parameters },
            },
        });
        let downlink: Downlink = serde_json::from_value(sent).unwrap();
        let again = serde_json::to_value(&downlink).unwrap();
        assert_eq!(serde_json::from_value::<Downlink>(again).unwrap(), downlink);
        let model = downlink.model.unwrap();
        assert_eq!((model.version, model.model.samples_used), (4, 0));
    }

    #[test]
    fn a_model_of_another_form_does_not_spoil_the_downlink() {
        let replaces = json!({ "since": "2026-11-20T00:00:00Z", "reason": "lightning_or_shock" });
        for model in [
            json!({ "version": 2, "parameters_over_lambda": {} }),
            json!("a word"),
        ] {
            let sent = json!({
                "contiguous_seq": 12, "server_time": "2026-11-21T07:00:00Z",
                "settings": Settings::default(),
                "model": { "id": ID, "version": 5, "data_until": "2026-11-20T00:00:00Z",
                           "replaces": replaces, "model": model },
            });
            let downlink: Downlink = serde_json::from_value(sent).unwrap();
            assert_eq!((downlink.contiguous_seq, &downlink.model), (12, &None));
            assert!(downlink.settings.is_some());
            let unread = downlink.unread.unwrap();
            assert_eq!(unread.version, Some(5));
            assert_eq!(unread.replaces.unwrap().reason, "lightning_or_shock");
        }
    }

    #[test]
    fn a_caution_from_a_later_version_does_not_spoil_the_model() {
        let nothing = json!({
            "bx_nt": 0.0, "chi13": 0.0, "by_nt": 0.0, "chi23": 0.0, "chi11_minus_chi22": 0.0,
            "chi12": 0.0, "chi21": 0.0, "constant_deg": 0.0,
        });
        let sent = json!({
            "contiguous_seq": 12, "server_time": "2026-11-21T07:00:00Z",
            "model": {
                "id": ID, "version": 5, "data_until": "2026-11-20T00:00:00Z",
                "model": {
                    "parameters_over_lambda": nothing,
                    "quality": {
                        "effective_samples": 9.0, "condition": null, "from_data": nothing,
                        "cautions": [{ "caution": "full_moon", "phase": 0.5 },
                                     { "caution": "weak_field", "h_nt": 5000.0 }],
                    },
                },
            },
        });
        let downlink: Downlink = serde_json::from_value(sent).unwrap();
        let cautions = downlink.model.unwrap().model.quality.unwrap().cautions;
        assert_eq!(cautions.len(), 2);
        assert!(cautions[1].to_string().contains("5000 nT"));
    }

    #[test]
    fn a_downlink_gives_the_reason_for_withdrawing_the_card() {
        let sent = json!({
            "contiguous_seq": 12, "server_time": "2026-11-21T07:00:00Z",
            "card_withdrawn": { "since": "2026-11-20T00:00:00Z", "reason": "corrector_change" },
        });
        let withdrawn = assert_comes_back::<Downlink>(&sent).card_withdrawn.unwrap();
        assert_eq!(
            withdrawn.to_string(),
            "the card has not held since 2026-11-20T00:00:00Z (corrector change)"
        );
    }

    #[test]
    fn settings_out_of_range_spoil_the_downlink() {
        let mut settings = serde_json::to_value(Settings::default()).unwrap();
        settings["min_sog_kn"] = json!(-4.0);
        let sent = json!({
            "contiguous_seq": 0, "server_time": "2026-11-21T07:00:00Z", "settings": settings,
        });
        let error = serde_json::from_value::<Downlink>(sent).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("min_sog_kn -4 is outside 0 to 50"),
            "{error}"
        );
    }
}
