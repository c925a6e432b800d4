//! Messages to the service manager that started the agent: that it is up, that it works, and how.
//!
//! Invariants:
//!
//! - `READY` is sent when instruments, outputs and page are open.
//! - The watchdog is fed by the loop that reads, stores and sends, once a second, and by nothing
//!   else. An agent whose loop hangs, or whose uplink has died, is restarted.
//! - Without a service manager nothing is sent.

use crate::status::Status;
use sd_notify::NotifyState;

/// Service manager that started the agent.
#[derive(Debug, Default)]
pub(super) struct ServiceManager {
    /// Last status line that was sent.
    line: String,
}

impl ServiceManager {
    /// Reports that the agent is up.
    pub(super) fn report_ready() {
        notify(&[NotifyState::Ready]);
    }

    /// Feeds the watchdog, and reports the status where it has changed.
    pub(super) fn feed_watchdog(&mut self, status: &Status) {
        let line = status.line();
        if line == self.line {
            notify(&[NotifyState::Watchdog]);
        } else {
            notify(&[NotifyState::Watchdog, NotifyState::Status(&line)]);
            self.line = line;
        }
    }

    /// Reports that the agent is stopping.
    pub(super) fn report_stopping() {
        notify(&[NotifyState::Stopping]);
    }
}

fn notify(states: &[NotifyState<'_>]) {
    if let Err(error) = sd_notify::notify(states) {
        tracing::debug!(%error, "the service manager cannot be reached");
    }
}
