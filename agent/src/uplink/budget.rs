//! How often the shore is spoken to, and how much of that a day may cost.
//!
//! What always holds:
//!
//! - When to speak is decided where batches are sealed: at once for an alert, else by
//!   the age of the oldest sample or by their number. What is sealed goes as soon as
//!   the budget allows.
//! - A budget is earned by the ship's clock or the computer's, whichever is ahead, and
//!   never beyond [`SAVED_DAYS`]: a clock that jumps earns no more than that, one that
//!   stands still keeps nothing back, and accelerated data are not held up.
//! - Evidence of an alert may overdraw by [`OVERDRAFT_DAYS`] of the budget; reports and
//!   samples may not, and what has no samples leaves [`RESERVE_DAYS`] to those. What
//!   cannot be afforded waits, and is never dropped.

use super::client::Line;
use crate::short_burst;
use binnacle_magnetics::time::Timestamp;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::time::Duration;
use tokio::time::Instant;

const DAY_S: f64 = 86_400.0;
const SAVED_DAYS: f64 = 3.0;
const OVERDRAFT_DAYS: f64 = 2.0;
const RESERVE_DAYS: f64 = 0.25;
/// What waits is thinned when it would take the budget of so many days.
const BACKLOG_DAYS: f64 = 7.0;
/// A connection is kept open for batches that come as often as this.
const KEEPS_LINE_FOR_S: u32 = 3_600;
/// The largest batch with its evidence takes a minute at 2,400 bits a second; many of its
/// packets may have to be sent again.
pub(crate) const EXCHANGE: Duration = Duration::from_mins(10);
/// How long a connection may be idle that is closed when all is said.
pub(crate) const IDLE_CONNECTION: Duration = Duration::from_secs(5);
/// TCP and TLS 1.3 until the first request, with a certificate of one's own authority;
/// and a request with its answer on an open connection, both without their bodies.
/// Measured as IP octets both ways.
const CONNECTION_OCTETS: f64 = 1_700.0;
pub(crate) const REQUEST_OCTETS: u64 = 389;
/// Where nobody answers: three times a first segment.
const UNANSWERED_OCTETS: f64 = 180.0;
/// Headers and acknowledgements of the segments that a body takes.
const SEGMENT_SHARE: f64 = 1.07;

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
pub(crate) struct Plan {
    pub(crate) profile: Profile,
    /// Seals when the first sample is so old, unless the shore has a wish of its own.
    pub(crate) seal_s: u32,
    /// So many octets a day, all counted, both ways.
    pub(crate) day_octets: Option<f64>,
}

impl Profile {
    /// The plan, with a budget of the operator's own if there is one.
    pub(crate) fn plan(self, day_octets: Option<f64>) -> Plan {
        let (seal_s, budget) = match self {
            Profile::Standard => (6 * 3_600, None),
            Profile::Broadband => (600, None),
            Profile::Vsat => (3_600, Some(64_000.0)),
            Profile::Metered => (86_400, Some(8_000.0)),
            Profile::VeryMetered => (3 * 86_400, Some(3_000.0)),
            Profile::ShortBurst => (86_400, None),
        };
        Plan {
            profile: self,
            seal_s,
            day_octets: day_octets.or(budget),
        }
    }
}

impl Plan {
    /// Asks for news when nothing was sent for so long: half as long again as between
    /// two batches, so that a ship under way never opens a connection for it.
    pub(crate) fn poll(&self) -> Duration {
        Duration::from_secs(u64::from(self.seal_s) * 3 / 2)
    }

    /// A batch is thinned when it is larger.
    pub(crate) fn batch_octets(&self) -> Option<usize> {
        (self.profile == Profile::ShortBurst).then(short_burst::batch_octets)
    }

    /// Whether the connection stays open between two batches. An hourly batch costs some
    /// 400 octets on an open connection and 2,000 on a new one. More seldom it is closed
    /// at once: behind a satellite or a firewall it would be gone without a word, and to
    /// keep it alive would cost more than to open another, which resumes the TLS session.
    pub(crate) fn keeps_line(&self) -> bool {
        self.seal_s <= KEEPS_LINE_FOR_S
    }

    /// How connections are used.
    pub(crate) fn line(&self) -> Line {
        // A stretch may take its time to end, and a ship may turn.
        let kept = 2 * Duration::from_secs(u64::from(KEEPS_LINE_FOR_S));
        Line {
            idle: if self.keeps_line() {
                kept
            } else {
                IDLE_CONNECTION
            },
            resumes: f64::from(self.seal_s) < DAY_S,
            exchange: EXCHANGE,
        }
    }

    /// What may wait before it is thinned, in octets as they are paid for.
    pub(crate) fn backlog_octets(&self) -> Option<u64> {
        self.day_octets.map(|day| (day * BACKLOG_DAYS) as u64)
    }
}

/// How urgent something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    /// Evidence of an alert.
    Alert,
    /// What an officer reports.
    Report,
    /// Samples.
    Samples,
    /// Counts without samples, and asking for news.
    Rest,
}

/// What is left of a budget, as it is kept over a restart.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Account {
    pub(crate) profile: Profile,
    /// Octets a day; none: as many as it takes.
    pub(crate) day_octets: Option<f64>,
    /// Less than none when overdrawn.
    pub(crate) left_octets: f64,
    /// The ship's time of all this.
    pub(crate) ship_time: Option<Timestamp>,
}

/// A plan at work.
#[derive(Debug)]
pub(crate) struct Budget {
    account: Account,
    /// When the account was right.
    at: Instant,
    /// A connection serves so long after the last request.
    connection_lasts: Duration,
    /// When something was last sent.
    sent: Option<Instant>,
}

/// The time by both clocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Now {
    pub(crate) monotonic: Instant,
    pub(crate) ship: Option<Timestamp>,
}

impl Budget {
    /// With what was left when the agent stopped, or a day's worth.
    pub(crate) fn new(
        plan: &Plan,
        before: Option<Account>,
        connection_lasts: Duration,
        now: Instant,
    ) -> Budget {
        let day = plan.day_octets.unwrap_or_default();
        let before = before.filter(|before| before.left_octets.is_finite());
        let left = before.map_or(day, |before| before.left_octets);
        Budget {
            account: Account {
                profile: plan.profile,
                day_octets: plan.day_octets,
                left_octets: left.clamp(-OVERDRAFT_DAYS * day, SAVED_DAYS * day),
                ship_time: before.and_then(|before| before.ship_time),
            },
            at: now,
            connection_lasts,
            sent: None,
        }
    }

    /// What is left, to be kept over a restart.
    pub(crate) fn account(&self) -> Account {
        self.account
    }

    /// What is left where it is less than a day's, in hundredths of that; less than none when
    /// overdrawn.
    pub(crate) fn short_percent(&self) -> Option<i32> {
        let day = self.account.day_octets.filter(|day| *day > 0.0)?;
        let left = (100.0 * self.account.left_octets / day).round() as i32;
        (left < 100).then_some(left)
    }

    /// How long to wait before a body of `octets` may go; nothing when it may go now.
    pub(crate) fn wait(&mut self, class: Class, octets: usize, now: Now) -> Option<Duration> {
        self.earn(now);
        let day = self.account.day_octets?;
        let least = match class {
            Class::Alert => -OVERDRAFT_DAYS * day,
            Class::Report | Class::Samples => 0.0,
            Class::Rest => RESERVE_DAYS * day,
        };
        // What costs more than is ever saved goes when there is no more to save.
        let affordable = |cost: f64| (cost + least).min(SAVED_DAYS * day);
        let missing = |cost: f64| affordable(cost) - self.account.left_octets;
        if missing(self.cost(octets, now.monotonic)) <= 0.0 {
            return None;
        }
        // By then a connection that is open now is not any more.
        let cost = CONNECTION_OCTETS + Budget::request(octets);
        let seconds = (missing(cost) / day * DAY_S).ceil();
        Some(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX))
    }

    /// Pays for a request before it is made; the sum, in case that nobody answers.
    pub(crate) fn spend(&mut self, octets: usize, now: Now) -> f64 {
        self.earn(now);
        let cost = self.cost(octets, now.monotonic);
        self.account.left_octets -= cost;
        self.sent = Some(now.monotonic);
        cost
    }

    /// There was no connection: what was paid for it comes back.
    pub(crate) fn take_back(&mut self, cost: f64) {
        self.account.left_octets += cost - UNANSWERED_OCTETS.min(cost);
        self.sent = None;
    }

    /// Pays for an answer's body.
    pub(crate) fn answered(&mut self, octets: u64) {
        self.account.left_octets -= octets as f64 * SEGMENT_SHARE;
    }

    fn cost(&self, octets: usize, now: Instant) -> f64 {
        let is_open = self
            .sent
            .is_some_and(|sent| now.saturating_duration_since(sent) < self.connection_lasts);
        let connection = if is_open { 0.0 } else { CONNECTION_OCTETS };
        connection + Budget::request(octets)
    }

    fn request(octets: usize) -> f64 {
        REQUEST_OCTETS as f64 + octets as f64 * SEGMENT_SHARE
    }

    fn earn(&mut self, now: Now) {
        let passed = now.monotonic.saturating_duration_since(self.at);
        let at_sea = match (now.ship, self.account.ship_time) {
            (Some(now), Some(before)) => now.seconds_since(before),
            _ => 0.0,
        };
        self.at = now.monotonic;
        self.account.ship_time = now.ship.or(self.account.ship_time);
        let Some(day) = self.account.day_octets else {
            self.account.left_octets = 0.0;
            return;
        };
        let earned = passed.as_secs_f64().max(at_sea) / DAY_S * day;
        self.account.left_octets = (self.account.left_octets + earned).min(SAVED_DAYS * day);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOUR: Duration = Duration::from_hours(1);
    const LASTS: Duration = Duration::from_secs(5);

    fn budget(profile: Profile, start: Now) -> Budget {
        Budget::new(&profile.plan(None), None, LASTS, start.monotonic)
    }

    fn start() -> Now {
        Now {
            monotonic: Instant::now(),
            ship: None,
        }
    }

    fn after(start: Now, passed: Duration) -> Now {
        Now {
            monotonic: start.monotonic + passed,
            ..start
        }
    }

    fn ship_time(days: f64) -> Timestamp {
        let start = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        start.plus_seconds(days * DAY_S)
    }

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

    #[test]
    fn without_a_budget_what_is_sealed_is_sent() {
        let now = start();
        let mut budget = budget(Profile::Standard, now);
        for _ in 0..1000 {
            assert_eq!(budget.wait(Class::Rest, 4000, now), None);
            budget.spend(4000, now);
        }
    }

    #[test]
    fn an_ordinary_month_of_each_profile_is_never_held_up() {
        for (profile, octets) in [
            (Profile::Vsat, 80),
            (Profile::Metered, 700),
            (Profile::VeryMetered, 2_000),
        ] {
            let start = start();
            let mut budget = budget(profile, start);
            let seal = Duration::from_secs(u64::from(profile.plan(None).seal_s));
            let month = HOUR * 24 * 30;
            let mut now = start;
            while now.monotonic < start.monotonic + month {
                now = after(now, seal);
                let waits = budget.wait(Class::Samples, octets, now);
                assert_eq!(waits, None, "{profile}");
                budget.spend(octets, now);
                // The acknowledgement.
                budget.answered(90);
            }
        }
    }

    #[test]
    fn a_backlog_is_sent_as_the_budget_allows_and_alerts_before_that() {
        let start = start();
        let mut budget = budget(Profile::Metered, start);
        let mut sent = 0;
        while budget.wait(Class::Samples, 500, start).is_none() {
            budget.spend(500, start);
            sent += 1;
        }
        // 8000 octets less a connection, at some 924 a batch.
        assert_eq!(sent, 6);
        assert!(budget.wait(Class::Report, 500, start).is_some());
        let mut alerts = 0;
        while budget.wait(Class::Alert, 500, start).is_none() {
            budget.spend(500, start);
            alerts += 1;
        }
        assert!((15..20).contains(&alerts), "{alerts}");
        let wait = budget.wait(Class::Samples, 500, start).unwrap();
        assert!((HOUR * 48..HOUR * 56).contains(&wait), "{wait:?}");
        let later = after(start, wait);
        assert_eq!(budget.wait(Class::Samples, 500, later), None);
    }

    #[test]
    fn what_has_no_samples_leaves_a_part_to_those() {
        let now = start();
        let mut budget = budget(Profile::Metered, now);
        budget.spend(2_700, now);
        let later = after(now, LASTS);
        assert_eq!(budget.wait(Class::Samples, 0, later), None);
        let wait = budget.wait(Class::Rest, 0, later).unwrap();
        assert_eq!(budget.wait(Class::Rest, 0, after(later, wait)), None);
    }

    #[test]
    fn a_restart_earns_nothing_and_a_large_batch_goes_in_the_end() {
        let start = start();
        let plan = Profile::VeryMetered.plan(None);
        let mut account = budget(Profile::VeryMetered, start).account();
        account.left_octets = -1e9;
        let mut budget = Budget::new(&plan, Some(account), LASTS, start.monotonic);
        assert!((budget.account().left_octets + 6_000.0).abs() < 1e-9);
        let mut now = start;
        for _ in 0..50 {
            match budget.wait(Class::Samples, 200_000, now) {
                Some(wait) => now = after(now, wait),
                None => return,
            }
        }
        panic!("it waits for ever");
    }

    #[test]
    fn no_jump_of_the_ships_clock_earns_more_than_is_ever_saved_or_takes_anything() {
        let mut now = start();
        let mut budget = budget(Profile::Metered, now);
        // A week roll-over, there and back.
        for (days, left) in [
            (0.0, 8_000.0),
            (1.0, 16_000.0),
            (7_168.0, 24_000.0),
            (1.0, 24_000.0),
        ] {
            now.ship = Some(ship_time(days));
            assert_eq!(budget.wait(Class::Samples, 0, now), None);
            let account = budget.account();
            assert!((account.left_octets - left).abs() < 1e-6, "{account:?}");
        }
        budget.spend(6_000, now);
        let before = budget.account().left_octets;
        now.ship = None;
        assert_eq!(budget.wait(Class::Samples, 0, now), None);
        assert!((budget.account().left_octets - before).abs() < 1e-6);
        // The receiver is silent: the computer's clock will do.
        let later = after(now, HOUR * 3);
        assert_eq!(budget.wait(Class::Samples, 0, later), None);
        assert!((budget.account().left_octets - before - 1_000.0).abs() < 1e-6);
    }

    #[test]
    fn days_without_a_link_cost_next_to_nothing() {
        let start = start();
        let mut budget = budget(Profile::Metered, start);
        for hour in 0..72 {
            let now = after(start, HOUR * hour);
            assert_eq!(budget.wait(Class::Samples, 500, now), None, "{hour}");
            let cost = budget.spend(500, now);
            budget.take_back(cost);
        }
        assert!(budget.account().left_octets > 15_000.0);
    }
}
