//! Limit on corrector plans that are made at once.

use binnacle_adjustment::adjust::AdjustError;
use binnacle_platform::error::{Error, Result};
use std::sync::Arc;
use tokio::sync::Semaphore;

/// Corrector plans made at once.
const AT_ONCE: usize = 2;

/// Slots for corrector plans being made in this process: each takes a core for a second or
/// two while an adjuster at the berth waits for it.
#[derive(Clone, Debug)]
pub struct CorrectorPlanSlots(Arc<Semaphore>);

impl Default for CorrectorPlanSlots {
    fn default() -> CorrectorPlanSlots {
        CorrectorPlanSlots(Arc::new(Semaphore::new(AT_ONCE)))
    }
}

impl CorrectorPlanSlots {
    /// Runs a calculation of the planner in a slot, on a blocking thread.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the planner refuses its input.
    pub(crate) async fn run<T: Send + 'static>(
        &self,
        calculate: impl FnOnce() -> std::result::Result<T, AdjustError> + Send + 'static,
    ) -> Result<T> {
        let permit = Arc::clone(&self.0).acquire_owned().await;
        let permit = permit.map_err(anyhow::Error::from)?;
        let done = tokio::task::spawn_blocking(move || {
            let _permit = permit;
            calculate()
        });
        done.await?.map_err(|error| Error::Invalid {
            field: "plan",
            detail: error.to_string(),
        })
    }
}
