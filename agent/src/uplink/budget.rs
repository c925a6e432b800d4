//! Daily byte budget.
//!
//! Invariants:
//!
//! - The time of an upload is decided where batches are sealed: at once for an alert, otherwise by
//!   the age of the oldest sample or by their number. A sealed batch is sent as soon as the budget
//!   allows.
//! - The budget accrues by the GNSS clock or the computer's, whichever is ahead, up to
//!   [`MAX_SAVED_DAYS`]. A clock that jumps gains no more than that, one that stands still blocks
//!   nothing, and accelerated data are not delayed.
//! - Evidence of an alert may overdraw the budget by [`OVERDRAFT_DAYS`]. Reports and samples may
//!   not, and requests without samples leave [`RESERVE_DAYS`] to those. What cannot be afforded
//!   waits, and is never dropped.

use crate::config::UploadPlan;
use crate::spool::{BudgetAccount, REQUEST_BYTES};
use binnacle_compass::time::Timestamp;
use std::time::Duration;
use tokio::time::Instant;

const DAY_S: f64 = 86_400.0;
const MAX_SAVED_DAYS: f64 = 3.0;
const OVERDRAFT_DAYS: f64 = 2.0;
const RESERVE_DAYS: f64 = 0.25;
/// TCP and TLS 1.3 handshakes with a certificate of a private authority. Measured as IP bytes both
/// ways.
const CONNECTION_BYTES: f64 = 1_700.0;
/// Cost of an attempt without a connection: three first segments.
const UNANSWERED_BYTES: f64 = 180.0;
/// Overhead of headers and acknowledgements of a body's segments.
const SEGMENT_SHARE: f64 = 1.07;

/// Priority of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Priority {
    /// Evidence of an alert.
    Alert,
    /// Officer's report.
    Report,
    /// Samples.
    Samples,
    /// Counts without samples, and polls.
    Other,
}

/// Budget of a running agent.
#[derive(Debug)]
pub(crate) struct Budget {
    account: BudgetAccount,
    /// Time of the last accrual.
    updated_at: Instant,
    /// Time after the last request for which a connection stays open.
    connection_lifetime: Duration,
    /// Time of the last request.
    last_sent: Option<Instant>,
}

/// Time by both clocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClockReading {
    pub(crate) monotonic: Instant,
    pub(crate) ship: Option<Timestamp>,
}

impl Budget {
    /// Creates a budget with the balance of the last run, or with one day's.
    pub(crate) fn new(
        plan: &UploadPlan,
        before: Option<BudgetAccount>,
        connection_lifetime: Duration,
        now: Instant,
    ) -> Budget {
        let day = plan.daily_bytes.unwrap_or_default();
        let before = before.filter(|before| before.remaining_bytes.is_finite());
        let left = before.map_or(day, |before| before.remaining_bytes);
        Budget {
            account: BudgetAccount {
                profile: plan.profile,
                daily_bytes: plan.daily_bytes,
                remaining_bytes: left.clamp(-OVERDRAFT_DAYS * day, MAX_SAVED_DAYS * day),
                ship_time: before.and_then(|before| before.ship_time),
            },
            updated_at: now,
            connection_lifetime,
            last_sent: None,
        }
    }

    /// Returns the balance, to be kept over a restart.
    pub(crate) fn account(&self) -> BudgetAccount {
        self.account
    }

    /// Returns the balance as a percentage of a day's budget where it is less than that; negative
    /// when overdrawn.
    pub(crate) fn remaining_percent(&self) -> Option<i32> {
        let day = self.account.daily_bytes.filter(|day| *day > 0.0)?;
        let left = (100.0 * self.account.remaining_bytes / day).round() as i32;
        (left < 100).then_some(left)
    }

    /// Returns the delay before a body of `bytes` may be sent; `None` for none.
    pub(crate) fn delay_for(
        &mut self,
        priority: Priority,
        bytes: usize,
        now: ClockReading,
    ) -> Option<Duration> {
        self.accrue(now);
        let day = self.account.daily_bytes?;
        let least = match priority {
            Priority::Alert => -OVERDRAFT_DAYS * day,
            Priority::Report | Priority::Samples => 0.0,
            Priority::Other => RESERVE_DAYS * day,
        };
        // A cost above the largest balance is allowed at the largest balance.
        let affordable = |cost: f64| (cost + least).min(MAX_SAVED_DAYS * day);
        let missing = |cost: f64| affordable(cost) - self.account.remaining_bytes;
        if missing(self.cost(bytes, now.monotonic)) <= 0.0 {
            return None;
        }
        // A connection that is open now will be closed by then.
        let cost = CONNECTION_BYTES + Budget::request_cost(bytes);
        let seconds = (missing(cost) / day * DAY_S).ceil();
        Some(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX))
    }

    /// Charges a request before it is made. Returns the cost, for a refund.
    pub(crate) fn charge(&mut self, bytes: usize, now: ClockReading) -> f64 {
        self.accrue(now);
        let cost = self.cost(bytes, now.monotonic);
        self.account.remaining_bytes -= cost;
        self.last_sent = Some(now.monotonic);
        cost
    }

    /// Refunds a request that found no connection.
    pub(crate) fn refund(&mut self, cost: f64) {
        self.account.remaining_bytes += cost - UNANSWERED_BYTES.min(cost);
        self.last_sent = None;
    }

    /// Charges the body of a response.
    pub(crate) fn charge_response(&mut self, bytes: u64) {
        self.account.remaining_bytes -= bytes as f64 * SEGMENT_SHARE;
    }

    fn cost(&self, bytes: usize, now: Instant) -> f64 {
        let is_open = self.last_sent.is_some_and(|last_sent| {
            now.saturating_duration_since(last_sent) < self.connection_lifetime
        });
        let connection = if is_open { 0.0 } else { CONNECTION_BYTES };
        connection + Budget::request_cost(bytes)
    }

    fn request_cost(bytes: usize) -> f64 {
        REQUEST_BYTES as f64 + bytes as f64 * SEGMENT_SHARE
    }

    fn accrue(&mut self, now: ClockReading) {
        let passed = now.monotonic.saturating_duration_since(self.updated_at);
        let at_sea = match (now.ship, self.account.ship_time) {
            (Some(now), Some(before)) => now.seconds_since(before),
            _ => 0.0,
        };
        self.updated_at = now.monotonic;
        self.account.ship_time = now.ship.or(self.account.ship_time);
        let Some(day) = self.account.daily_bytes else {
            self.account.remaining_bytes = 0.0;
            return;
        };
        let earned = passed.as_secs_f64().max(at_sea) / DAY_S * day;
        self.account.remaining_bytes =
            (self.account.remaining_bytes + earned).min(MAX_SAVED_DAYS * day);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Profile;

    const HOUR: Duration = Duration::from_hours(1);
    const LASTS: Duration = Duration::from_secs(5);

    fn budget(profile: Profile, start: ClockReading) -> Budget {
        Budget::new(&profile.plan(None), None, LASTS, start.monotonic)
    }

    fn start() -> ClockReading {
        ClockReading {
            monotonic: Instant::now(),
            ship: None,
        }
    }

    fn after(start: ClockReading, passed: Duration) -> ClockReading {
        ClockReading {
            monotonic: start.monotonic + passed,
            ..start
        }
    }

    fn ship_time(days: f64) -> Timestamp {
        let start = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        start.plus_seconds(days * DAY_S)
    }

    #[test]
    fn without_a_budget_what_is_sealed_is_sent() {
        let now = start();
        let mut budget = budget(Profile::Standard, now);
        for _ in 0..1000 {
            assert_eq!(budget.delay_for(Priority::Other, 4000, now), None);
            budget.charge(4000, now);
        }
    }

    #[test]
    fn an_ordinary_month_of_each_profile_is_never_held_up() {
        for (profile, bytes) in [
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
                let waits = budget.delay_for(Priority::Samples, bytes, now);
                assert_eq!(waits, None, "{profile}");
                budget.charge(bytes, now);
                // The acknowledgement.
                budget.charge_response(90);
            }
        }
    }

    #[test]
    fn a_backlog_is_sent_as_the_budget_allows_and_alerts_before_that() {
        let start = start();
        let mut budget = budget(Profile::Metered, start);
        let mut sent = 0;
        while budget.delay_for(Priority::Samples, 500, start).is_none() {
            budget.charge(500, start);
            sent += 1;
        }
        // 8000 bytes less a connection, at some 924 a batch.
        assert_eq!(sent, 6);
        assert!(budget.delay_for(Priority::Report, 500, start).is_some());
        let mut alerts = 0;
        while budget.delay_for(Priority::Alert, 500, start).is_none() {
            budget.charge(500, start);
            alerts += 1;
        }
        assert!((15..20).contains(&alerts), "{alerts}");
        let delay_for = budget.delay_for(Priority::Samples, 500, start).unwrap();
        assert!((HOUR * 48..HOUR * 56).contains(&delay_for), "{delay_for:?}");
        let later = after(start, delay_for);
        assert_eq!(budget.delay_for(Priority::Samples, 500, later), None);
    }

    #[test]
    fn what_has_no_samples_leaves_a_part_to_those() {
        let now = start();
        let mut budget = budget(Profile::Metered, now);
        budget.charge(2_700, now);
        let later = after(now, LASTS);
        assert_eq!(budget.delay_for(Priority::Samples, 0, later), None);
        let delay_for = budget.delay_for(Priority::Other, 0, later).unwrap();
        assert_eq!(
            budget.delay_for(Priority::Other, 0, after(later, delay_for)),
            None
        );
    }

    #[test]
    fn a_restart_earns_nothing_and_a_large_batch_goes_in_the_end() {
        let start = start();
        let plan = Profile::VeryMetered.plan(None);
        let mut account = budget(Profile::VeryMetered, start).account();
        account.remaining_bytes = -1e9;
        let mut budget = Budget::new(&plan, Some(account), LASTS, start.monotonic);
        assert!((budget.account().remaining_bytes + 6_000.0).abs() < 1e-9);
        let mut now = start;
        for _ in 0..50 {
            match budget.delay_for(Priority::Samples, 200_000, now) {
                Some(delay_for) => now = after(now, delay_for),
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
            assert_eq!(budget.delay_for(Priority::Samples, 0, now), None);
            let account = budget.account();
            assert!((account.remaining_bytes - left).abs() < 1e-6, "{account:?}");
        }
        budget.charge(6_000, now);
        let before = budget.account().remaining_bytes;
        now.ship = None;
        assert_eq!(budget.delay_for(Priority::Samples, 0, now), None);
        assert!((budget.account().remaining_bytes - before).abs() < 1e-6);
        // The receiver is silent: the computer's clock serves.
        let later = after(now, HOUR * 3);
        assert_eq!(budget.delay_for(Priority::Samples, 0, later), None);
        assert!((budget.account().remaining_bytes - before - 1_000.0).abs() < 1e-6);
    }

    #[test]
    fn days_without_a_link_cost_next_to_nothing() {
        let start = start();
        let mut budget = budget(Profile::Metered, start);
        for hour in 0..72 {
            let now = after(start, HOUR * hour);
            assert_eq!(
                budget.delay_for(Priority::Samples, 500, now),
                None,
                "{hour}"
            );
            let cost = budget.charge(500, now);
            budget.refund(cost);
        }
        assert!(budget.account().remaining_bytes > 15_000.0);
    }
}
