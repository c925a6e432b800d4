//! Link profiles: the upload interval, the daily byte budget and the use of connections.

use binnacle_wire::burst::capacity;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::time::Duration;

const DAY_S: f64 = 86_400.0;
/// Days of budget above which the backlog is thinned.
const BACKLOG_DAYS: f64 = 7.0;
/// Longest upload interval for which a connection is kept open.
const KEEP_OPEN_INTERVAL_S: u32 = 3_600;
/// Timeout of an exchange. The largest batch with its evidence takes a minute at 2,400 bits a
/// second, and many of its packets may have to be sent again.
pub(super) const EXCHANGE_TIMEOUT: Duration = Duration::from_mins(10);
/// Idle timeout of a connection that is closed after each exchange.
const IDLE_TIMEOUT: Duration = Duration::from_secs(5);
/// Short messages of a batch; a larger batch is thinned.
const MESSAGES_A_BATCH: usize = 3;

/// Cost class of the link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Profile {
    /// Four times a day.
    #[default]
    Standard,
    /// Every ten minutes.
    Broadband,
    /// Every hour.
    Vsat,
    /// Once a day.
    Metered,
    /// Every three days.
    VeryMetered,
    /// Once a day, in three short messages over a modem.
    ShortBurst,
}

impl fmt::Display for Profile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Profile::Standard => "standard",
            Profile::Broadband => "broadband",
            Profile::Vsat => "vsat",
            Profile::Metered => "metered",
            Profile::VeryMetered => "very-metered",
            Profile::ShortBurst => "short-burst",
        })
    }
}

/// Upload interval and daily byte budget of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct UploadPlan {
    pub(crate) profile: Profile,
    /// Age of the oldest sample at which a batch is sealed, unless the server sets another.
    pub(crate) seal_s: u32,
    /// Byte budget per day: all traffic, both ways.
    pub(crate) daily_bytes: Option<f64>,
}

impl Profile {
    /// Returns the upload plan, with the operator's own budget if there is one.
    pub(crate) fn plan(self, daily_bytes: Option<f64>) -> UploadPlan {
        let (seal_s, budget) = match self {
            Profile::Standard => (6 * 3_600, None),
            Profile::Broadband => (600, None),
            Profile::Vsat => (3_600, Some(64_000.0)),
            Profile::Metered => (86_400, Some(8_000.0)),
            Profile::VeryMetered => (3 * 86_400, Some(3_000.0)),
            Profile::ShortBurst => (86_400, None),
        };
        UploadPlan {
            profile: self,
            seal_s,
            daily_bytes: daily_bytes.or(budget),
        }
    }
}

impl UploadPlan {
    /// Returns the interval of polls when nothing was sent: 1.5 upload intervals, so that a vessel
    /// under way never opens a connection for a poll.
    pub(crate) fn poll(&self) -> Duration {
        Duration::from_secs(u64::from(self.seal_s) * 3 / 2)
    }

    /// Returns the size above which a batch is thinned.
    pub(crate) fn max_batch_bytes(&self) -> Option<usize> {
        (self.profile == Profile::ShortBurst).then(max_burst_batch_bytes)
    }

    /// Returns whether the connection stays open between two batches.
    ///
    /// An hourly batch costs some 400 bytes on an open connection and 2,000 on a new one. At longer
    /// intervals the connection is closed at once. Behind a satellite or a firewall it would be
    /// dropped silently, and keep-alives would cost more than another connection that resumes the
    /// TLS session.
    pub(crate) fn keeps_connection(&self) -> bool {
        self.seal_s <= KEEP_OPEN_INTERVAL_S
    }

    /// Returns the connection policy of the profile.
    pub(crate) fn connection_policy(&self) -> ConnectionPolicy {
        // A sample may take a while to finish, and the vessel may turn.
        let kept = 2 * Duration::from_secs(u64::from(KEEP_OPEN_INTERVAL_S));
        ConnectionPolicy {
            idle_timeout: if self.keeps_connection() {
                kept
            } else {
                IDLE_TIMEOUT
            },
            resumes_tls: f64::from(self.seal_s) < DAY_S,
            exchange_timeout: EXCHANGE_TIMEOUT,
            allows_plain_http: false,
        }
    }

    /// Returns the largest backlog that is not thinned, in billed bytes.
    pub(crate) fn max_backlog_bytes(&self) -> Option<u64> {
        self.daily_bytes.map(|day| (day * BACKLOG_DAYS) as u64)
    }
}

/// Use of connections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ConnectionPolicy {
    /// Idle time after which a connection is not used again.
    pub(crate) idle_timeout: Duration,
    /// Resumption of TLS sessions: no ticket is valid for longer than a day.
    pub(crate) resumes_tls: bool,
    /// Timeout of a whole exchange, however busy the other side looks.
    pub(crate) exchange_timeout: Duration,
    /// Unencrypted connections to other computers.
    pub(crate) allows_plain_http: bool,
}

/// Returns the size of the largest batch that fits into its short messages.
pub(crate) fn max_burst_batch_bytes() -> usize {
    capacity(MESSAGES_A_BATCH)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_names_are_those_of_the_configuration() {
        for profile in [
            Profile::Standard,
            Profile::Broadband,
            Profile::Vsat,
            Profile::Metered,
            Profile::VeryMetered,
            Profile::ShortBurst,
        ] {
            let name = serde_json::to_string(&profile).unwrap();
            assert_eq!(name, format!("\"{profile}\""));
        }
    }
}
