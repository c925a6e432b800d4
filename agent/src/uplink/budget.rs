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
//! - The balance is of bytes counted at the socket ([`super::meter`]). An expected cost decides what
//!   may be sent, and is charged until the request is over. The connection in it is what the last
//!   one cost on this link, with its certificates and proxies.

use super::meter::Traffic;
use crate::config::UploadPlan;
use crate::spool::{BudgetAccount, REQUEST_BYTES};
use binnacle_compass::time::Timestamp;
use std::time::Duration;
use tokio::time::Instant;

const DAY_S: f64 = 86_400.0;
const MAX_SAVED_DAYS: f64 = 3.0;
const OVERDRAFT_DAYS: f64 = 2.0;
const RESERVE_DAYS: f64 = 0.25;
/// Cost of a connection before one was counted: TCP and TLS 1.3 handshakes with a certificate of a
/// private authority. Measured as IP bytes both ways.
const CONNECTION_BYTES: f64 = 1_700.0;
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

/// Connection of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Connection {
    /// One that is open.
    Open,
    /// One that has to be opened.
    New,
}

/// Budget of a running agent.
#[derive(Debug)]
pub(crate) struct Budget {
    account: BudgetAccount,
    /// Time of the last accrual.
    updated_at: Instant,
}

/// Time by both clocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClockReading {
    pub(crate) monotonic: Instant,
    pub(crate) ship: Option<Timestamp>,
}

impl Budget {
    /// Creates a budget with the balance of the last run, or with one day's.
    pub(crate) fn new(plan: &UploadPlan, before: Option<BudgetAccount>, now: Instant) -> Budget {
        let day = plan.daily_bytes.unwrap_or_default();
        let before = before.filter(|before| before.remaining_bytes.is_finite());
        let left = before.map_or(day, |before| before.remaining_bytes);
        Budget {
            account: BudgetAccount {
                profile: plan.profile,
                daily_bytes: plan.daily_bytes,
                remaining_bytes: left.clamp(-OVERDRAFT_DAYS * day, MAX_SAVED_DAYS * day),
                ship_time: before.and_then(|before| before.ship_time),
                connection_bytes: before
                    .and_then(|before| before.connection_bytes)
                    .filter(|bytes| bytes.is_finite() && *bytes > 0.0),
                total_bytes: before.map_or(0.0, |before| before.total_bytes),
            },
            updated_at: now,
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
        connection: Connection,
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
        if missing(self.cost(bytes, connection)) <= 0.0 {
            return None;
        }
        // A connection that is open now will be closed by then.
        let seconds = (missing(self.cost(bytes, Connection::New)) / day * DAY_S).ceil();
        Some(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX))
    }

    /// Charges the expected cost of a request before it is made, and returns it.
    pub(crate) fn charge(
        &mut self,
        bytes: usize,
        connection: Connection,
        now: ClockReading,
    ) -> f64 {
        self.accrue(now);
        let cost = self.cost(bytes, connection);
        self.account.remaining_bytes -= cost;
        cost
    }

    /// Charges the counted traffic in place of the expected cost, and learns what a connection costs.
    pub(crate) fn settle(&mut self, expected: f64, counted: Traffic) {
        let bytes = counted.bytes as f64;
        self.account.remaining_bytes += expected - bytes;
        self.account.total_bytes += bytes;
        if let Some(bytes) = counted.connection_bytes {
            self.account.connection_bytes = Some(bytes as f64);
        }
    }

    fn cost(&self, bytes: usize, connection: Connection) -> f64 {
        let connection = match connection {
            Connection::Open => 0.0,
            Connection::New => self.account.connection_bytes.unwrap_or(CONNECTION_BYTES),
        };
        connection + REQUEST_BYTES as f64 + bytes as f64 * SEGMENT_SHARE
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

    fn budget(profile: Profile, start: ClockReading) -> Budget {
        Budget::new(&profile.plan(None), None, start.monotonic)
    }

    /// Traffic of a request, on a connection of this cost if it was opened for it.
    fn counted(bytes: u64, connection_bytes: Option<u64>) -> Traffic {
        Traffic {
            bytes: bytes + connection_bytes.unwrap_or_default(),
            connection_bytes,
        }
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
            let waits = budget.delay_for(Priority::Other, 4000, Connection::New, now);
            assert_eq!(waits, None);
            budget.charge(4000, Connection::New, now);
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
                let waits = budget.delay_for(Priority::Samples, bytes, Connection::New, now);
                assert_eq!(waits, None, "{profile}");
                let expected = budget.charge(bytes, Connection::New, now);
                budget.settle(expected, counted(bytes as u64 + 500, Some(1_900)));
            }
        }
    }

    #[test]
    fn a_backlog_is_sent_as_the_budget_allows_and_alerts_before_that() {
        let start = start();
        let mut budget = budget(Profile::Metered, start);
        // The first request opens the connection, which then stays open.
        budget.charge(500, Connection::New, start);
        let mut sent = 1;
        let waits = |budget: &mut Budget, priority| {
            budget.delay_for(priority, 500, Connection::Open, start)
        };
        while waits(&mut budget, Priority::Samples).is_none() {
            budget.charge(500, Connection::Open, start);
            sent += 1;
        }
        // 8000 bytes less a connection, at some 924 a batch.
        assert_eq!(sent, 6);
        assert!(waits(&mut budget, Priority::Report).is_some());
        let mut alerts = 0;
        while waits(&mut budget, Priority::Alert).is_none() {
            budget.charge(500, Connection::Open, start);
            alerts += 1;
        }
        assert!((15..20).contains(&alerts), "{alerts}");
        let delay = waits(&mut budget, Priority::Samples).unwrap();
        assert!((HOUR * 48..HOUR * 56).contains(&delay), "{delay:?}");
        let later = after(start, delay);
        let waits = budget.delay_for(Priority::Samples, 500, Connection::New, later);
        assert_eq!(waits, None);
    }

    #[test]
    fn what_has_no_samples_leaves_a_part_to_those() {
        let now = start();
        let mut budget = budget(Profile::Metered, now);
        budget.charge(2_700, Connection::New, now);
        let mut waits = |priority, now| budget.delay_for(priority, 0, Connection::New, now);
        assert_eq!(waits(Priority::Samples, now), None);
        let delay = waits(Priority::Other, now).unwrap();
        assert_eq!(waits(Priority::Other, after(now, delay)), None);
    }

    #[test]
    fn a_restart_earns_nothing_and_a_large_batch_goes_in_the_end() {
        let start = start();
        let plan = Profile::VeryMetered.plan(None);
        let mut account = budget(Profile::VeryMetered, start).account();
        account.remaining_bytes = -1e9;
        let mut budget = Budget::new(&plan, Some(account), start.monotonic);
        assert!((budget.account().remaining_bytes + 6_000.0).abs() < 1e-9);
        let mut now = start;
        for _ in 0..50 {
            match budget.delay_for(Priority::Samples, 200_000, Connection::New, now) {
                Some(delay) => now = after(now, delay),
                None => return,
            }
        }
        panic!("it waits for ever");
    }

    #[test]
    fn no_jump_of_the_ships_clock_earns_more_than_is_ever_saved_or_takes_anything() {
        let mut now = start();
        let mut budget = budget(Profile::Metered, now);
        let waits =
            |budget: &mut Budget, now| budget.delay_for(Priority::Samples, 0, Connection::New, now);
        // A week roll-over, there and back.
        for (days, left) in [
            (0.0, 8_000.0),
            (1.0, 16_000.0),
            (7_168.0, 24_000.0),
            (1.0, 24_000.0),
        ] {
            now.ship = Some(ship_time(days));
            assert_eq!(waits(&mut budget, now), None);
            let account = budget.account();
            assert!((account.remaining_bytes - left).abs() < 1e-6, "{account:?}");
        }
        budget.charge(6_000, Connection::New, now);
        let before = budget.account().remaining_bytes;
        now.ship = None;
        assert_eq!(waits(&mut budget, now), None);
        assert!((budget.account().remaining_bytes - before).abs() < 1e-6);
        // The receiver is silent: the computer's clock serves.
        let later = after(now, HOUR * 3);
        assert_eq!(waits(&mut budget, later), None);
        assert!((budget.account().remaining_bytes - before - 1_000.0).abs() < 1e-6);
    }

    #[test]
    fn days_without_a_link_cost_next_to_nothing() {
        let start = start();
        let mut budget = budget(Profile::Metered, start);
        for hour in 0..72 {
            let now = after(start, HOUR * hour);
            let waits = budget.delay_for(Priority::Samples, 500, Connection::New, now);
            assert_eq!(waits, None, "{hour}");
            let expected = budget.charge(500, Connection::New, now);
            budget.settle(expected, counted(180, None));
        }
        assert!(budget.account().remaining_bytes > 15_000.0);
    }

    #[test]
    fn a_dear_certificate_is_paid_for_and_planned_with_also_after_a_restart() {
        let start = start();
        let plan = Profile::VeryMetered.plan(None);
        let mut first = Budget::new(&plan, None, start.monotonic);
        let expected = first.charge(500, Connection::New, start);
        first.settle(expected, counted(900, Some(4_400)));
        assert!((first.account().remaining_bytes - (3_000.0 - 5_300.0)).abs() < 1e-9);
        assert!((first.account().total_bytes - 5_300.0).abs() < 1e-9);
        let mut next = Budget::new(&plan, Some(first.account()), start.monotonic);
        let delay = next
            .delay_for(Priority::Samples, 500, Connection::New, start)
            .unwrap();
        // 2300 bytes overdrawn, 4400 for the connection, 924 for the request.
        let days = delay.as_secs_f64() / DAY_S;
        assert!((days - 7_624.0 / 3_000.0).abs() < 1e-4, "{days}");
        // A month of it stays within the budget, whatever was planned at first.
        let mut now = start;
        let mut spent = 5_300.0;
        while now.monotonic < start.monotonic + HOUR * 24 * 30 {
            let delay = next.delay_for(Priority::Samples, 500, Connection::New, now);
            if let Some(delay) = delay {
                now = after(now, delay);
                continue;
            }
            let expected = next.charge(500, Connection::New, now);
            next.settle(expected, counted(900, Some(4_400)));
            spent += 5_300.0;
            now = after(now, HOUR * 24);
        }
        assert!((80_000.0..=96_000.0).contains(&spent), "{spent}");
    }
}
