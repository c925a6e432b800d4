//! State of the page's handlers.

use crate::sampler::Exclusion;
use crate::spool::Spool;
use crate::status::Status;
use std::sync::Arc;
use tokio::sync::{Notify, watch};
use uuid::Uuid;

/// State of the page's handlers.
#[derive(Clone, Debug)]
pub(crate) struct PageState {
    pub(crate) spool: Spool,
    pub(crate) status: watch::Receiver<Arc<Status>>,
    pub(crate) exclusion: watch::Sender<Option<Exclusion>>,
    /// Last alert that an officer acknowledged.
    pub(crate) acknowledged: watch::Sender<Option<Uuid>>,
    /// Wakes the uplink when there is something to send.
    pub(crate) upload_wakeup: Arc<Notify>,
}
