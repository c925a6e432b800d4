//! Link profiles: the upload interval, the daily byte budget and the use of connections.

use binnacle_wire::burst::capacity;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::time::Duration;

const DAY_S: f64 = 86_400.0;
/// What waits is thinned when it would take the budget of so many days.
const BACKLOG_DAYS: f64 = 7.0;
/// A connection is kept open for batches that come as often as this.
const KEEP_OPEN_INTERVAL_S: u32 = 3_600;
/// The largest batch with its evidence takes a minute at 2,400 bits a second; many of its
/// packets may have to be sent again.
pub(super) const EXCHANGE_TIMEOUT: Duration = Duration::from_mins(10);
/// How long a connection may be idle that is closed when all is said.
const IDLE_TIMEOUT: Duration = Duration::from_secs(5);
/// A batch is thinned until it fits into so many messages.
const MESSAGES_A_BATCH: usize = 3;

/// What the link costs, in a word.
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

/// What a profile comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct UploadPlan {
    pub(crate) profile: Profile,
    /// Seals when the first sample is so old, unless the shore has a wish of its own.
    pub(crate) seal_s: u32,
    /// So many octets a day, all counted, both ways.
    pub(crate) daily_bytes: Option<f64>,
}

impl Profile {
    /// The plan, with a budget of the operator's own if there is one.
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
    /// Asks for news when nothing was sent for so long: half as long again as between
    /// two batches, so that a ship under way never opens a connection for it.
    pub(crate) fn poll(&self) -> Duration {
        Duration::from_secs(u64::from(self.seal_s) * 3 / 2)
    }

    /// A batch is thinned when it is larger.
    pub(crate) fn max_batch_bytes(&self) -> Option<usize> {
        (self.profile == Profile::ShortBurst).then(max_burst_batch_bytes)
    }

    /// Whether the connection stays open between two batches. An hourly batch costs some
    /// 400 octets on an open connection and 2,000 on a new one. More seldom it is closed
    /// at once: behind a satellite or a firewall it would be gone without a word, and to
    /// keep it alive would cost more than to open another, which resumes the TLS session.
    pub(crate) fn keeps_connection(&self) -> bool {
        self.seal_s <= KEEP_OPEN_INTERVAL_S
    }

    /// How connections are used.
    pub(crate) fn connection_policy(&self) -> ConnectionPolicy {
        // A stretch may take its time to end, and a ship may turn.
        let kept = 2 * Duration::from_secs(u64::from(KEEP_OPEN_INTERVAL_S));
        ConnectionPolicy {
            idle_timeout: if self.keeps_connection() {
                kept
            } else {
                IDLE_TIMEOUT
            },
            resumes_tls: f64::from(self.seal_s) < DAY_S,
            exchange_timeout: EXCHANGE_TIMEOUT,
        }
    }

    /// What may wait before it is thinned, in octets as they are paid for.
    pub(crate) fn max_backlog_bytes(&self) -> Option<u64> {
        self.daily_bytes.map(|day| (day * BACKLOG_DAYS) as u64)
    }
}

/// How connections are used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ConnectionPolicy {
    /// A connection serves again when it was idle for less than this.
    pub(crate) idle_timeout: Duration,
    /// Whether a TLS session is offered again: for a day, no ticket holds longer.
    pub(crate) resumes_tls: bool,
    /// An exchange that takes longer is given up, however busy whoever answers looks.
    pub(crate) exchange_timeout: Duration,
}

/// The size of the largest batch that fits into its short messages.
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
