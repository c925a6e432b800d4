//! How the link is, and what the shore decides, for the rest of the agent.

use binnacle_magnetics::time::Timestamp;
use binnacle_wire::messages::{CardWithdrawn, ModelDownlink, Settings};
use serde::{Deserialize, Serialize};
use tokio::sync::watch;

/// How the link is, for the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LinkStatus {
    /// In one word.
    pub(crate) state: LinkState,
    /// What is wrong, in words.
    pub(crate) problem: Option<String>,
    /// When the shore last answered, by its clock.
    pub(crate) last_contact: Option<Timestamp>,
}

/// How the link is, in one word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum LinkState {
    /// There is no token: see `enrol`.
    #[default]
    NotEnrolled,
    /// The first try is under way.
    Connecting,
    /// The last request was answered.
    Up,
    /// The last request was not answered.
    Down,
    /// The shore does not know the token or the stream.
    Refused,
}

/// What the shore decides, as it is now.
#[derive(Debug)]
pub(crate) struct Publisher {
    /// The model to steer by.
    pub(crate) model: watch::Sender<Option<ModelDownlink>>,
    /// Why that model holds no more.
    pub(crate) withdrawn: watch::Sender<Option<CardWithdrawn>>,
    /// How to sample and send.
    pub(crate) settings: watch::Sender<Settings>,
    /// How the link is.
    pub(crate) link: watch::Sender<LinkStatus>,
}
