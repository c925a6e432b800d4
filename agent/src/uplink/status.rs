//! State of the link, and publication of the server's decisions to the rest of the agent.

use binnacle_compass::time::Timestamp;
use binnacle_wire::messages::{CardWithdrawn, ModelDownlink, Settings};
use serde::{Deserialize, Serialize};
use tokio::sync::watch;

/// State of the link, for the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LinkStatus {
    /// State in one word.
    pub(crate) state: LinkState,
    /// Description of the fault.
    pub(crate) problem: Option<String>,
    /// Time of the server's last response, by its clock.
    pub(crate) last_contact: Option<Timestamp>,
}

/// State of the link in one word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum LinkState {
    /// No token: see `enrol`.
    #[default]
    NotEnrolled,
    /// First attempt under way.
    Connecting,
    /// Last request succeeded.
    Up,
    /// Last request failed.
    Down,
    /// Token or stream unknown to the server.
    Refused,
}

impl LinkState {
    /// Returns the state in words.
    pub(crate) fn words(self) -> &'static str {
        match self {
            LinkState::NotEnrolled => "not enrolled",
            LinkState::Connecting => "connecting",
            LinkState::Up => "up",
            LinkState::Down => "down",
            LinkState::Refused => "refused",
        }
    }
}

/// Publisher of the server's decisions.
#[derive(Debug)]
pub(crate) struct Publisher {
    /// Current model.
    pub(crate) model: watch::Sender<Option<ModelDownlink>>,
    /// Withdrawal of that model.
    pub(crate) withdrawn: watch::Sender<Option<CardWithdrawn>>,
    /// Settings of sampling and upload.
    pub(crate) settings: watch::Sender<Settings>,
    /// State of the link.
    pub(crate) link: watch::Sender<LinkStatus>,
}
