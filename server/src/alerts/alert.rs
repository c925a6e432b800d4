//! What an alert says.

use crate::ids::{AlertId, CompassId, VesselId};
use crate::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// What an alert is about: one compass has at most one open alert of each.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema, sqlx::Type,
)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = AlertCause)]
pub enum Cause {
    /// The deviation exceeds the vessel's limit on some heading.
    DeviationOverLimit,
    /// Gyro and satellite compass contradict each other.
    ReferenceFault,
    /// The magnetic compass sticks, repeats itself or swings.
    CompassFault,
    /// A strike, or a heavy blow to the hull.
    LightningOrShock,
    /// Steel, scrap or the like on board.
    MagneticCargo,
    /// The ship's magnetism wandered off.
    Drift,
    /// The compass's zero moved: its lubber line, its seat, or its sensor.
    Alignment,
    /// The earth's crust, at a place.
    LocalAnomaly,
    /// The sun, for hours.
    MagneticStorm,
    /// The quay's and its cranes' iron.
    BerthSteel,
    /// A change of which no cause is likely.
    UnknownChange,
    /// Headings at sea do not agree with what an adjustment foretold.
    AdjustmentNotConfirmed,
    /// An adjustment that was agreed with a firm does not fit any more.
    AgreedJobAtRisk,
    /// The ship's agent says that compass and gyro have parted.
    ReportedAboard,
    /// Nothing has come from the vessel for too long.
    SilentAgent,
    /// Two computers send as one agent.
    ClonedAgent,
    /// There is no model although samples have come for a while.
    NoModel,
    /// The model is less certain than the vessel's limit asks.
    WideBand,
}

/// How bad it is.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema, sqlx::Type,
)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
pub enum Severity {
    /// To be known.
    Notice,
    /// To be acted on.
    Warning,
    /// The compass must not be relied on.
    Critical,
}

/// How far people have come with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = AlertState)]
pub enum State {
    /// Nobody has acknowledged it.
    Raised,
    /// Someone knows; its cause goes on.
    Acknowledged,
    /// It is over, or someone said so.
    Cleared,
}

/// An alert that ought to be open.
#[derive(Clone, Debug, PartialEq)]
pub struct DesiredAlert {
    /// What it is about.
    pub cause: Cause,
    /// How bad it is.
    pub severity: Severity,
    /// When its cause began, as far as that is known.
    pub since: Time,
    /// What an alert of this cause was dated if it was about the same event.
    pub window: EventWindow,
    /// What is so, in a sentence.
    pub summary: String,
    /// What to do.
    pub advice: &'static str,
    /// What shows it.
    pub evidence: Evidence,
}

/// The dates that an event may have been given before, when less was known of it.
///
/// The default is any date: of what goes on, rather than happened at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EventWindow {
    /// Not before this.
    pub from: Option<Time>,
    /// Not after this.
    pub to: Option<Time>,
}

impl EventWindow {
    /// This date and no other.
    pub fn exactly(at: Time) -> EventWindow {
        EventWindow {
            from: Some(at),
            to: Some(at),
        }
    }

    /// Whether an alert of that date was about this event.
    pub fn includes(&self, date: Time) -> bool {
        self.from.is_none_or(|from| from <= date) && self.to.is_none_or(|to| date <= to)
    }
}

/// What shows something, a sentence each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Evidence(pub Vec<String>);

impl TryFrom<String> for Evidence {
    type Error = serde_json::Error;

    fn try_from(text: String) -> std::result::Result<Evidence, serde_json::Error> {
        serde_json::from_str(&text).map(Evidence)
    }
}

/// An alert.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
pub struct Alert {
    /// The alert's id.
    pub id: AlertId,
    /// The vessel.
    pub vessel_id: VesselId,
    /// Her name.
    #[schema(example = "Nao Victoria")]
    pub vessel_name: String,
    /// The compass.
    pub compass_id: CompassId,
    /// The compass's name.
    #[schema(example = "Standard compass")]
    pub compass_name: String,
    /// What it is about.
    pub cause: Cause,
    /// How bad it is.
    pub severity: Severity,
    /// How far people have come with it.
    pub state: State,
    /// When its cause began, as far as that is known.
    pub since: Time,
    /// What is so, in a sentence.
    #[schema(example = "Deviation is 7.4° E on compass heading 095°, over the limit of 5°.")]
    pub summary: String,
    /// What to do.
    pub advice: String,
    /// What shows it, a sentence each.
    #[sqlx(try_from = "String")]
    #[schema(value_type = Vec<String>)]
    pub evidence: Evidence,
    /// When it was raised.
    pub raised_at: Time,
    /// When it last said something new.
    pub updated_at: Time,
    /// When someone acknowledged it.
    #[schema(required)]
    pub acknowledged_at: Option<Time>,
    /// Who.
    #[schema(required)]
    pub acknowledged_by: Option<String>,
    /// In that person's words.
    #[schema(required)]
    pub acknowledgement_note: Option<String>,
    /// When it was cleared.
    #[schema(required)]
    pub cleared_at: Option<Time>,
    /// Who cleared it; none when it cleared itself.
    #[schema(required)]
    pub cleared_by: Option<String>,
    /// Why.
    #[schema(required)]
    pub clearing_reason: Option<String>,
}

/// A page of alerts.
#[derive(Serialize, ToSchema)]
pub(super) struct AlertList {
    /// The newest first.
    pub items: Vec<Alert>,
    /// `after` of the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// Which alerts.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Filter {
    /// Only of this vessel.
    pub vessel: Option<VesselId>,
    /// Only in this state.
    pub state: Option<State>,
    /// Whether only those that are not cleared (`true`), or only those that are.
    pub open: Option<bool>,
    /// Only as bad as this or worse.
    pub severity: Option<Severity>,
}

/// That someone knows.
#[derive(Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Acknowledgement {
    /// In that person's words.
    #[schema(max_length = 200, example = "Master informed; azimuth taken")]
    pub note: Option<String>,
}

/// That an alert is over.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Clearing {
    /// Why.
    #[schema(min_length = 1, max_length = 200, example = "Adjusted at Algeciras")]
    pub reason: String,
}

impl Alert {
    /// Whether it is closed because what it told of is over, or somebody said so.
    pub fn is_over(&self) -> bool {
        self.cleared_by.is_some() || self.clearing_reason.as_deref() == Some(super::reconcile::OVER)
    }
}

impl Severity {
    /// This one and all that are worse, the last one repeated: as many as a query
    /// has places for.
    pub(super) fn and_worse(self) -> [Severity; 3] {
        match self {
            Severity::Notice => [Severity::Notice, Severity::Warning, Severity::Critical],
            Severity::Warning => [Severity::Warning, Severity::Critical, Severity::Critical],
            Severity::Critical => [Severity::Critical; 3],
        }
    }
}

impl Cause {
    /// Whether an analysis finds it, and finds when it is over.
    pub fn is_of_an_analysis(self) -> bool {
        !matches!(
            self,
            Cause::SilentAgent
                | Cause::ReportedAboard
                | Cause::ClonedAgent
                | Cause::AgreedJobAtRisk
        )
    }

    /// Whether the clock finds it rather than an analysis.
    pub fn is_of_the_clock(self) -> bool {
        self == Cause::SilentAgent
    }

    /// Whether it is something that happened at a time, which later samples date better.
    pub(super) fn is_dated_anew(self) -> bool {
        matches!(
            self,
            Cause::LightningOrShock
                | Cause::MagneticCargo
                | Cause::Drift
                | Cause::Alignment
                | Cause::UnknownChange
                | Cause::LocalAnomaly
                | Cause::MagneticStorm
                | Cause::BerthSteel
        )
    }

    /// The cause in a few words.
    pub fn words(self) -> &'static str {
        match self {
            Cause::DeviationOverLimit => "deviation over the limit",
            Cause::ReferenceFault => "gyro and satellite compass disagree",
            Cause::CompassFault => "a fault of the compass",
            Cause::LightningOrShock => "lightning or a shock",
            Cause::MagneticCargo => "magnetic cargo",
            Cause::Drift => "drift of the ship's magnetism",
            Cause::Alignment => "the compass's zero moved",
            Cause::LocalAnomaly => "a local anomaly",
            Cause::MagneticStorm => "a magnetic storm",
            Cause::BerthSteel => "steel at the berth",
            Cause::UnknownChange => "a change of unknown cause",
            Cause::AdjustmentNotConfirmed => "an adjustment that the sea does not confirm",
            Cause::AgreedJobAtRisk => "an agreed adjustment that does not fit any more",
            Cause::ReportedAboard => "compass and gyro parted, says the ship",
            Cause::SilentAgent => "no word from the vessel",
            Cause::ClonedAgent => "two computers send as one agent",
            Cause::NoModel => "no model of the compass yet",
            Cause::WideBand => "the model is too uncertain",
        }
    }
}
