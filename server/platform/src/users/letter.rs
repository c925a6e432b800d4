//! Letters with one-time codes.
//!
//! Invariant: a letter with a code goes to the relay at once and is stored nowhere.

use crate::app::App;
use crate::mail;
use std::time::Duration;
use tracing::warn;

/// Time for the relay to take a letter.
const RELAY_PATIENCE: Duration = Duration::from_secs(15);

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
