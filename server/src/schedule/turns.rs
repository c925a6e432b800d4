//! Who may make a plan now: it takes a core for seconds.
//!
//! What always holds: few plans are made at once, and of one operator's one at a time, so that
//! whoever asks again and again waits for themselves and keeps nobody else waiting.

use crate::error::Result;
use crate::ids::OperatorId;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::{OwnedMutexGuard, OwnedSemaphorePermit, Semaphore};

/// Plans that are made at once.
const AT_ONCE: usize = 2;

/// That an operator's plan is being made.
pub(super) type Turn = OwnedMutexGuard<()>;

/// The plans of this process that are being made, and those that wait.
#[derive(Clone, Debug)]
pub struct Turns {
    places: Arc<Semaphore>,
    of: Arc<Mutex<BTreeMap<OperatorId, Arc<tokio::sync::Mutex<()>>>>>,
}

impl Default for Turns {
    fn default() -> Turns {
        Turns {
            places: Arc::new(Semaphore::new(AT_ONCE)),
            of: Arc::default(),
        }
    }
}

impl Turns {
    /// An operator's turn, once nobody else has it.
    pub(super) async fn turn_of(&self, operator: OperatorId) -> Turn {
        self.queue_of(operator).lock_owned().await
    }

    /// An operator's turn, if nobody has it.
    pub(super) fn free_turn_of(&self, operator: OperatorId) -> Option<Turn> {
        self.queue_of(operator).try_lock_owned().ok()
    }

    /// A place among the plans that are made at once.
    ///
    /// # Errors
    /// Never, as long as nobody closes the places.
    pub(super) async fn place(&self) -> Result<OwnedSemaphorePermit> {
        let place = Arc::clone(&self.places).acquire_owned().await;
        Ok(place.map_err(anyhow::Error::from)?)
    }

    fn queue_of(&self, operator: OperatorId) -> Arc<tokio::sync::Mutex<()>> {
        let mut all = self.of.lock().unwrap_or_else(PoisonError::into_inner);
        // Who has no turn and waits for none is forgotten.
        all.retain(|_, queue| Arc::strong_count(queue) > 1);
        Arc::clone(all.entry(operator).or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures_util::FutureExt;

    #[tokio::test]
    async fn of_one_operator_one_plan_is_made_at_a_time_and_others_do_not_wait_for_it() {
        let turns = Turns::default();
        let (ada, eve) = (OperatorId::new(), OperatorId::new());
        let first = turns.turn_of(ada).await;
        assert!(turns.turn_of(ada).now_or_never().is_none());
        assert!(turns.free_turn_of(ada).is_none());
        assert!(turns.free_turn_of(eve).is_some());
        drop(first);
        assert!(turns.turn_of(ada).now_or_never().is_some());
    }
}
