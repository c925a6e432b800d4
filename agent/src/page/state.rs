//! State of the page's handlers.

use super::pin_guard::PinGuard;
use crate::clock;
use crate::sampler::Exclusion;
use crate::spool::Spool;
use crate::status::Status;
use binnacle_compass::time::Timestamp;
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
    /// Guard of the actions that alter something.
    pub(crate) guard: Arc<PinGuard>,
}

impl PageState {
    /// Returns the time on board. Either clock may lag far behind; neither is ahead without reason.
    pub(super) fn now(&self) -> Timestamp {
        let ship_time = self.status.borrow().ship_time;
        ship_time.map_or_else(clock::now, |time| time.max(clock::now()))
    }
}
