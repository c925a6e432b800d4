//! Limit on concurrent solvers, each of which takes a core for seconds.
//!
//! Invariants: few plans are made at once, and one at a time for each operator. Repeated requests
//! of an operator wait for each other and delay no other operator.

use binnacle_platform::error::Result;
use binnacle_platform::ids::OperatorId;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::{OwnedMutexGuard, OwnedSemaphorePermit, Semaphore};

/// Maximum number of concurrent solvers.
const MAX_CONCURRENT: usize = 2;

/// Exclusive right to make an operator's plan.
pub(super) type PlanLock = OwnedMutexGuard<()>;

/// Slots for the concurrent solvers of this process, and a lock for each operator.
#[derive(Clone, Debug)]
pub struct PlanSlots {
    slots: Arc<Semaphore>,
    locks: Arc<Mutex<BTreeMap<OperatorId, Arc<tokio::sync::Mutex<()>>>>>,
}

impl Default for PlanSlots {
    fn default() -> PlanSlots {
        PlanSlots {
            slots: Arc::new(Semaphore::new(MAX_CONCURRENT)),
            locks: Arc::default(),
        }
    }
}

impl PlanSlots {
    /// Waits for an operator's lock and takes it.
    pub(super) async fn lock_of(&self, operator: OperatorId) -> PlanLock {
        self.operator_mutex(operator).lock_owned().await
    }

    /// Takes an operator's lock if it is free.
    pub(super) fn try_lock_of(&self, operator: OperatorId) -> Option<PlanLock> {
        self.operator_mutex(operator).try_lock_owned().ok()
    }

    /// Waits for a slot to make a plan in.
    ///
    /// # Errors
    /// Never, as long as nobody closes the semaphore.
    pub(super) async fn acquire(&self) -> Result<OwnedSemaphorePermit> {
        let permit = Arc::clone(&self.slots).acquire_owned().await;
        Ok(permit.map_err(anyhow::Error::from)?)
    }

    fn operator_mutex(&self, operator: OperatorId) -> Arc<tokio::sync::Mutex<()>> {
        let mut all = self.locks.lock().unwrap_or_else(PoisonError::into_inner);
        // A lock that nobody holds or waits for is dropped.
        all.retain(|_, lock| Arc::strong_count(lock) > 1);
        Arc::clone(all.entry(operator).or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures_util::FutureExt;

    #[tokio::test]
    async fn one_plan_of_an_operator_is_made_at_a_time_and_others_do_not_wait() {
        let slots = PlanSlots::default();
        let (ada, eve) = (OperatorId::new(), OperatorId::new());
        let first = slots.lock_of(ada).await;
        assert!(slots.lock_of(ada).now_or_never().is_none());
        assert!(slots.try_lock_of(ada).is_none());
        assert!(slots.try_lock_of(eve).is_some());
        drop(first);
        assert!(slots.lock_of(ada).now_or_never().is_some());
    }
}
