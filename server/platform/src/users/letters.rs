//! Letters with one-time codes, and how many of them are sent.
//!
//! Invariants: a letter with a code goes to the relay at once and is stored nowhere. Nobody can have
//! the server write to one address all day, or keep all of the relay's connections.

use crate::app::App;
use crate::error::{Error, Result};
use crate::mail;
use crate::request_rates::RequestRates;
use crate::secret;
use crate::tenants::Tenant;
use binnacle_compass::time::Timestamp;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tracing::warn;

/// Letters of strangers' requests that are on their way at once.
const AT_ONCE: usize = 4;
/// Letters to one address in a day (UTC).
const TO_ADDRESS: u32 = 5;
/// Requests for a code from one network in a day.
const FROM_NETWORK: u32 = 50;
/// Invitations of one company's admins in a day.
const OF_COMPANY: u32 = 200;
/// Time for the relay to take a letter.
const RELAY_PATIENCE: Duration = Duration::from_secs(15);

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
    pub(super) fn for_stranger(
        &self,
        network: &str,
        now: Timestamp,
    ) -> Result<OwnedSemaphorePermit> {
        let permit = Arc::clone(&self.at_once).try_acquire_owned();
        let permit = permit.map_err(|_| Error::Throttled {
            retry_after_s: RELAY_PATIENCE.as_secs(),
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
    pub(super) fn may_invite(&self, by: Option<Tenant>, now: Timestamp) -> bool {
        let company = secret::hash(&format!("company {by:?}"));
        let quota = self.today.count(company, seconds(now), OF_COMPANY);
        !quota.is_exceeded
    }

    fn may_write_to(&self, address: &str, now: Timestamp) -> bool {
        let address = secret::hash(&format!("address {address}"));
        let quota = self.today.count(address, seconds(now), TO_ADDRESS);
        !quota.is_exceeded
    }
}

fn seconds(now: Timestamp) -> u64 {
    u64::try_from(now.micros() / 1_000_000).unwrap_or(0)
}

/// Letter with a code.
pub(super) struct Letter<'a> {
    pub(super) address: &'a str,
    pub(super) subject: &'a str,
    pub(super) paragraphs: &'a [&'a str],
}

impl Letter<'_> {
    /// Sends the letter with the page that uses a code; returns whether the relay has taken it. It
    /// is not sent to an address that had several today.
    pub(super) async fn send(&self, app: &App, code: &str) -> bool {
        let now = app.clock.now();
        let sender = match mail::Sender::new(&app.config.mail) {
            Ok(Some(sender)) => sender.with_patience(RELAY_PATIENCE),
            Ok(None) => return false,
            Err(error) => {
                warn!(error = format!("{error:#}"), "mail cannot be sent");
                return false;
            }
        };
        if !app.letters.may_write_to(self.address, now) {
            warn!("an address has had several letters with codes today: it gets no other");
            return false;
        }
        let path = format!("/invitation#{code}");
        let sent = sender
            .write(
                self.address,
                self.subject,
                self.paragraphs,
                &path,
                now.into(),
            )
            .await;
        if let Err(error) = &sent {
            warn!(
                error = format!("{error:#}"),
                "a letter with a code was not sent"
            );
        }
        sent.is_ok()
    }
}
