//! Hashing of passwords, by a few at a time. Each hash takes 19 MB and a core, so that its memory
//! is kept and used again: otherwise every thread that ever hashed would hold its own.

use super::check;
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

    /// Checks a new password as [`check`] does, and returns its hash, as it is stored. Both keep a
    /// core busy, so the permit moves into the task here too.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::error::Error::Invalid) with `field`; fails when there is too little
    /// memory.
    pub async fn hash_new(
        mut self,
        field: &'static str,
        password: String,
        about: &[&str],
    ) -> Result<String> {
        let about: Vec<String> = about.iter().map(|text| (*text).to_owned()).collect();
        let hashed = tokio::task::spawn_blocking(move || {
            let about: Vec<&str> = about.iter().map(String::as_str).collect();
            check(field, &password, &about)?;
            Ok(secret::hash_password(&password, &mut self.memory)?)
        });
        hashed.await?
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
        let password = "nine bells at noon".to_owned();
        let stored = permit.hash_new("password", password, &[]).await.unwrap();
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
