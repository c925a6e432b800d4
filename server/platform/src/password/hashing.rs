//! Hashing of passwords, by a few at a time. Each hash takes 19 MB and a core, so that its memory
//! is kept and used again: otherwise every thread that ever hashed would hold its own.

use crate::error::Result;
use crate::secret::{self, HashMemory};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Number of passwords hashed concurrently.
const AT_ONCE: usize = 2;

/// Limit on concurrent hashing, with the memory that is free.
#[derive(Debug)]
pub struct Hashing {
    permits: Arc<Semaphore>,
    free: Mutex<Vec<HashMemory>>,
}

impl Default for Hashing {
    fn default() -> Hashing {
        Hashing {
            permits: Arc::new(Semaphore::new(AT_ONCE)),
            free: Mutex::default(),
        }
    }
}

impl Hashing {
    /// Waits for a turn.
    ///
    /// # Errors
    /// Fails when the server is stopping.
    pub async fn acquire(self: &Arc<Hashing>) -> Result<Permit> {
        let permit = self.permits.clone().acquire_owned().await;
        let permit = permit.map_err(anyhow::Error::from)?;
        let memory = self.free().pop().unwrap_or_default();
        Ok(Permit {
            memory,
            hashing: self.clone(),
            _turn: permit,
        })
    }

    fn free(&self) -> std::sync::MutexGuard<'_, Vec<HashMemory>> {
        self.free.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// One's turn of hashing, with its memory.
#[derive(Debug)]
pub struct Permit {
    memory: HashMemory,
    hashing: Arc<Hashing>,
    _turn: OwnedSemaphorePermit,
}

impl Permit {
    /// Checks a password. The permit moves into the task, so that it is held while the hashing
    /// lasts, even if nobody waits for the result any more.
    ///
    /// # Errors
    /// Fails when the server is stopping.
    pub async fn matches(
        mut self,
        password: String,
        stored: Option<String>,
    ) -> Result<(bool, Permit)> {
        let matches = tokio::task::spawn_blocking(move || {
            let stored = stored.as_deref();
            let matches = secret::password_matches(&password, stored, &mut self.memory);
            (matches, self)
        });
        Ok(matches.await?)
    }

    /// Returns the hash of a password, as it is stored.
    ///
    /// # Errors
    /// Fails when there is too little memory.
    pub async fn hash(mut self, password: String) -> Result<String> {
        let hashed =
            tokio::task::spawn_blocking(move || secret::hash_password(&password, &mut self.memory));
        Ok(hashed.await??)
    }
}

impl Drop for Permit {
    fn drop(&mut self) {
        self.hashing.free().push(std::mem::take(&mut self.memory));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn memory_is_used_again() {
        let hashing = Arc::new(Hashing::default());
        for _ in 0..2 {
            let permits = (hashing.acquire().await, hashing.acquire().await);
            drop(permits);
        }
        assert_eq!(hashing.free().len(), AT_ONCE);
        let permit = hashing.acquire().await.unwrap();
        let stored = permit.hash("nine bells at noon".to_owned()).await.unwrap();
        let permit = hashing.acquire().await.unwrap();
        let (matches, permit) = permit
            .matches("nine bells at noon".to_owned(), Some(stored.clone()))
            .await
            .unwrap();
        assert!(matches);
        let (matches, permit) = permit
            .matches("eight bells at noon".to_owned(), Some(stored))
            .await
            .unwrap();
        assert!(!matches);
        drop(permit);
        assert_eq!(hashing.free().len(), AT_ONCE);
    }
}
