//! State of the page's handlers.

use crate::sampler::Exclusion;
use crate::spool::Spool;
use crate::status::Status;
use std::sync::Arc;
use tokio::sync::{Notify, watch};
use uuid::Uuid;

/// What the page's handlers work with.
#[derive(Clone, Debug)]
pub(crate) struct PageState {
    pub(crate) spool: Spool,
    pub(crate) status: watch::Receiver<Arc<Status>>,
    pub(crate) exclusion: watch::Sender<Option<Exclusion>>,
    /// The alert that an officer has seen.
    pub(crate) acknowledged: watch::Sender<Option<Uuid>>,
    /// Rings when there is something to send.
    pub(crate) upload_wakeup: Arc<Notify>,
}
