//! Limits on letters with one-time codes.
//!
//! Invariants: nobody can have the server write to one address all day, or keep all of the relay's
//! connections.

use super::RequestRates;
use crate::error::{Error, Result};
use crate::secret;
use crate::tenants::Tenant;
use binnacle_compass::time::Timestamp;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Letters of strangers' requests that are on their way at once.
const AT_ONCE: usize = 4;
/// Letters to one address in a day (UTC).
const TO_ADDRESS: u32 = 5;
/// Requests for a code from one network in a day.
const FROM_NETWORK: u32 = 50;
/// Invitations of one company's admins in a day.
const OF_COMPANY: u32 = 200;
/// Time after which a letter of those that are on their way has gone, seconds.
const GONE_AFTER_S: u64 = 15;

/// Limits on letters with codes, in this process.
#[derive(Debug)]
pub struct Letters {
    at_once: Arc<Semaphore>,
    today: RequestRates,
}

impl Default for Letters {
    fn default() -> Letters {
        Letters {
            at_once: Arc::new(Semaphore::new(AT_ONCE)),
            today: RequestRates::daily(),
        }
    }
}

impl Letters {
    /// Counts a stranger's request for a code, and returns the permit for its letter.
    ///
    /// # Errors
    /// [`Error::Throttled`] when the network had its number today, or too many letters are on their
    /// way.
    pub fn for_stranger(&self, network: &str, now: Timestamp) -> Result<OwnedSemaphorePermit> {
        let permit = Arc::clone(&self.at_once).try_acquire_owned();
        let permit = permit.map_err(|_| Error::Throttled {
            retry_after_s: GONE_AFTER_S,
        })?;
        let caller = secret::hash(&format!("network {network}"));
        let quota = self.today.count(caller, seconds(now), FROM_NETWORK);
        if quota.is_exceeded {
            return Err(Error::Throttled {
                retry_after_s: quota.resets_in_s,
            });
        }
        Ok(permit)
    }

    /// Counts an invitation by a company's admin; false when it had its number today.
    pub fn may_invite(&self, by: Option<Tenant>, now: Timestamp) -> bool {
        let company = secret::hash(&format!("company {by:?}"));
        let quota = self.today.count(company, seconds(now), OF_COMPANY);
        !quota.is_exceeded
    }

    /// Counts a letter to an address; false when it had its number today.
    pub fn may_write_to(&self, address: &str, now: Timestamp) -> bool {
        let address = secret::hash(&format!("address {address}"));
        let quota = self.today.count(address, seconds(now), TO_ADDRESS);
        !quota.is_exceeded
    }
}

fn seconds(now: Timestamp) -> u64 {
    u64::try_from(now.micros() / 1_000_000).unwrap_or(0)
}
