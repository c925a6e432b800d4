//! Heading-difference alarm: the corrected heading and a reference differ by more than a limit.
//!
//! It is plainer and faster than the alert of [`super::AlertMonitor`], which weighs the model's
//! band and waits for settled windows. Invariants:
//!
//! - A mean over ten seconds is judged, so that rolling and yawing neither raise nor clear it.
//! - It is raised once the mean has exceeded the limit for the set time, and cleared once it has
//!   been below a share of the limit for as long.
//! - Where there is nothing to compare, it stays as it is, for ten minutes at most: also after a
//!   restart, which keeps the alarm and its acknowledgement.

use crate::config::AlertConfig;
use binnacle_compass::angle::{TrueHeading, wrap_180};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::time::Duration;
use tokio::time::Instant;
use uuid::Uuid;

/// Time over which differences are averaged: a period or two of a compass's swing.
const MEAN_TIME: Duration = Duration::from_secs(10);
/// Share of the limit below which the headings agree again.
const CLEARED_SHARE: f64 = 0.8;
/// Time without a comparison after which the alarm ends.
const MAX_UNJUDGED: Duration = Duration::from_mins(10);

/// Reference that the corrected heading is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum DifferenceReference {
    Gyro,
    SatelliteCompass,
}

impl DifferenceReference {
    /// Returns the name in a text.
    pub(crate) fn name(self) -> &'static str {
        match self {
            DifferenceReference::Gyro => "gyro",
            DifferenceReference::SatelliteCompass => "satellite compass",
        }
    }
}

/// Corrected heading and reference of one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Comparison {
    pub(crate) corrected: TrueHeading,
    pub(crate) reference_heading: TrueHeading,
    pub(crate) reference: DifferenceReference,
}

/// The last alarm, open or over.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct HeadingDifference {
    pub(crate) id: Uuid,
    pub(crate) is_open: bool,
    pub(crate) acknowledged: bool,
    pub(crate) reference: DifferenceReference,
    /// Corrected heading less reference: the latest mean.
    pub(crate) difference_deg: f64,
    pub(crate) limit_deg: f64,
}

/// Alarm as the page and `status` show it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct HeadingDifferenceStatus {
    #[serde(flatten)]
    pub(crate) alarm: HeadingDifference,
    /// Description of the difference.
    #[serde(rename = "says")]
    pub(crate) summary: String,
    /// Advice to the officer; empty once the alarm is over.
    pub(crate) advice: String,
}

/// State between two comparisons.
#[derive(Debug)]
pub(crate) struct DifferenceMonitor {
    limit_deg: f64,
    time: Duration,
    /// Differences of the last [`MEAN_TIME`], oldest first.
    recent: VecDeque<(Instant, f64)>,
    /// Time since which the mean speaks for a change of the alarm.
    since: Option<Instant>,
    /// Time of the last comparison, or of the start.
    last_compared: Instant,
    last: Option<HeadingDifference>,
}

impl DifferenceMonitor {
    /// Creates a monitor with the last alarm from before a restart, if there was any.
    pub(crate) fn new(
        config: &AlertConfig,
        last: Option<HeadingDifference>,
        now: Instant,
    ) -> DifferenceMonitor {
        DifferenceMonitor {
            limit_deg: config.difference_deg.0,
            time: config.difference_s.duration(),
            recent: VecDeque::new(),
            since: None,
            last_compared: now,
            last,
        }
    }

    /// Returns the last alarm, open or over.
    pub(crate) fn last(&self) -> Option<&HeadingDifference> {
        self.last.as_ref()
    }

    /// Marks the alarm as acknowledged by an officer.
    pub(crate) fn acknowledge(&mut self, id: Uuid) {
        if let Some(alarm) = self.last.as_mut().filter(|alarm| alarm.id == id) {
            alarm.acknowledged = true;
        }
    }

    /// Compares once a second; `None` where a heading is missing. Returns whether the alarm was
    /// raised or cleared.
    pub(crate) fn observe(
        &mut self,
        comparison: Option<Comparison>,
        now: Instant,
        new_id: impl FnOnce() -> Uuid,
    ) -> bool {
        let Some(difference_deg) = self.mean(comparison, now) else {
            return self.end_unjudged(now);
        };
        let is_open = self.last.is_some_and(|alarm| alarm.is_open);
        if let Some(alarm) = self.last.as_mut().filter(|_| is_open) {
            alarm.difference_deg = difference_deg;
            alarm.reference = comparison.map_or(alarm.reference, |now| now.reference);
        }
        let is_changing = if is_open {
            difference_deg.abs() < CLEARED_SHARE * self.limit_deg
        } else {
            difference_deg.abs() > self.limit_deg
        };
        if !is_changing {
            self.since = None;
            return false;
        }
        let since = *self.since.get_or_insert(now);
        let Some(now_compared) = comparison else {
            return false;
        };
        if now.saturating_duration_since(since) < self.time {
            return false;
        }
        self.since = None;
        if let Some(alarm) = self.last.as_mut().filter(|_| is_open) {
            alarm.is_open = false;
            return true;
        }
        self.last = Some(HeadingDifference {
            id: new_id(),
            is_open: true,
            acknowledged: false,
            reference: now_compared.reference,
            difference_deg,
            limit_deg: self.limit_deg,
        });
        true
    }

    /// Returns the mean difference of the last [`MEAN_TIME`], as a direction: about 180° it has no
    /// jump.
    fn mean(&mut self, comparison: Option<Comparison>, now: Instant) -> Option<f64> {
        if let Some(compared) = comparison {
            let corrected_deg = compared.corrected.degrees();
            let difference_deg = wrap_180(corrected_deg - compared.reference_heading.degrees());
            self.recent.push_back((now, difference_deg));
            self.last_compared = now;
        }
        let is_old = |at: Instant| now.saturating_duration_since(at) >= MEAN_TIME;
        while self.recent.front().is_some_and(|(at, _)| is_old(*at)) {
            self.recent.pop_front();
        }
        if self.recent.is_empty() {
            return None;
        }
        let radians = self.recent.iter().map(|(_, degrees)| degrees.to_radians());
        let (sin, cos) = radians.fold((0.0, 0.0), |(sin, cos), radians: f64| {
            (sin + radians.sin(), cos + radians.cos())
        });
        Some(sin.atan2(cos).to_degrees())
    }

    fn end_unjudged(&mut self, now: Instant) -> bool {
        self.since = None;
        let unjudged = now.saturating_duration_since(self.last_compared);
        let is_over = unjudged >= MAX_UNJUDGED;
        let open = self.last.as_mut().filter(|alarm| alarm.is_open && is_over);
        let Some(alarm) = open else { return false };
        alarm.is_open = false;
        true
    }
}

impl HeadingDifference {
    /// Returns whether a stored alarm is the same but for the latest difference.
    pub(crate) fn is_stored_as(&self, stored: &HeadingDifference) -> bool {
        let state = |alarm: &HeadingDifference| (alarm.id, alarm.is_open, alarm.acknowledged);
        state(self) == state(stored)
    }

    /// Returns the alarm for the page and `status`.
    pub(crate) fn status(&self) -> HeadingDifferenceStatus {
        let reference = self.reference.name();
        let (summary, advice) = if self.is_open {
            let difference_deg = self.difference_deg.abs();
            let limit_deg = self.limit_deg;
            (
                format!(
                    "corrected heading and {reference} differ by {difference_deg:.0}°; the limit \
                     is {limit_deg}°"
                ),
                "Trust neither until one is proven: compare both with a steady course over \
                 ground, and take an azimuth.",
            )
        } else {
            (
                format!("corrected heading and {reference} no longer differ by too much"),
                "",
            )
        };
        HeadingDifferenceStatus {
            alarm: *self,
            summary,
            advice: advice.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Voyage {
        monitor: DifferenceMonitor,
        start: Instant,
        seconds: u64,
        raised: u128,
    }

    impl Voyage {
        fn new(config: &str) -> Voyage {
            let config: AlertConfig = toml::from_str(config).unwrap();
            let start = Instant::now();
            Voyage {
                monitor: DifferenceMonitor::new(&config, None, start),
                start,
                seconds: 0,
                raised: 0,
            }
        }

        /// Restarts the agent: only what is stored is kept.
        fn restart(&mut self) {
            let stored = serde_json::to_string(&self.monitor.last()).unwrap();
            let now = self.start + Duration::from_secs(self.seconds);
            let last = serde_json::from_str(&stored).unwrap();
            self.monitor = DifferenceMonitor::new(&AlertConfig::default(), last, now);
        }

        /// Compares for some seconds. Returns the second in which the alarm changed.
        fn sail(&mut self, seconds: u64, difference: impl Fn(u64) -> Option<f64>) -> Option<u64> {
            let mut changed = None;
            for second in 1..=seconds {
                self.seconds += 1;
                let heading = |degrees: f64| TrueHeading::new(degrees).unwrap();
                let comparison = difference(second).map(|degrees| Comparison {
                    corrected: heading(355.0 + degrees),
                    reference_heading: heading(355.0),
                    reference: DifferenceReference::Gyro,
                });
                let now = self.start + Duration::from_secs(self.seconds);
                self.raised += 1;
                let id = Uuid::from_u128(self.raised);
                if self.monitor.observe(comparison, now, || id) {
                    assert_eq!(changed.replace(second), None, "it changed twice");
                }
            }
            changed
        }

        fn is_open(&self) -> bool {
            self.monitor.last().is_some_and(|alarm| alarm.is_open)
        }
    }

    #[test]
    fn a_difference_above_the_limit_raises_the_alarm_within_a_minute() {
        for difference_deg in [10.5, 12.0, -25.0, 90.0, 180.0] {
            let mut voyage = Voyage::new("");
            assert_eq!(voyage.sail(600, |_| Some(1.0)), None);
            let raised = voyage.sail(60, |_| Some(difference_deg)).unwrap();
            assert!((45..60).contains(&raised), "{difference_deg}: {raised}");
            let alarm = voyage.monitor.last().unwrap();
            assert!(alarm.is_open && !alarm.acknowledged);
            assert!((alarm.difference_deg.abs() - difference_deg.abs()).abs() < 0.1);
        }
    }

    #[test]
    fn a_difference_below_the_limit_or_of_a_short_time_raises_nothing() {
        let mut voyage = Voyage::new("");
        assert_eq!(voyage.sail(3_600, |_| Some(9.5)), None);
        assert_eq!(voyage.sail(30, |_| Some(60.0)), None);
        assert_eq!(voyage.sail(600, |_| Some(1.0)), None);
        // The swing of a compass exceeds the limit for half of each period.
        let swing = |second: u64| Some(9.0 + if second % 10 < 5 { 4.0 } else { -4.0 });
        assert_eq!(voyage.sail(600, swing), None);
        assert_eq!(voyage.monitor.last(), None);
    }

    #[test]
    fn rolling_about_a_difference_above_the_limit_does_not_hide_it() {
        let mut voyage = Voyage::new("");
        let swing = |second: u64| Some(12.0 + if second % 10 < 5 { 6.0 } else { -6.0 });
        assert!(voyage.sail(60, swing).is_some());
    }

    #[test]
    fn limit_and_time_can_be_set() {
        let mut voyage = Voyage::new("difference_deg = 5\ndifference_s = 20");
        assert_eq!(voyage.sail(600, |_| Some(4.5)), None);
        let raised = voyage.sail(60, |_| Some(7.0)).unwrap();
        assert!((20..=30).contains(&raised), "{raised}");
        for wrong in [
            "difference_deg = 0",
            "difference_deg = 200",
            "difference_s = 0",
        ] {
            assert!(toml::from_str::<AlertConfig>(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn it_is_cleared_well_below_the_limit_alone_and_raised_anew_after_that() {
        let mut voyage = Voyage::new("");
        voyage.sail(120, |_| Some(15.0));
        let first = voyage.monitor.last().unwrap().id;
        assert_eq!(voyage.sail(600, |_| Some(9.0)), None);
        assert!(voyage.is_open());
        assert!(voyage.sail(60, |_| Some(2.0)).is_some());
        assert!(!voyage.is_open());
        assert_eq!(voyage.sail(600, |_| Some(9.0)), None);
        assert!(voyage.sail(60, |_| Some(15.0)).is_some());
        assert_ne!(voyage.monitor.last().unwrap().id, first);
    }

    #[test]
    fn without_a_heading_it_stays_for_ten_minutes_and_is_not_raised() {
        let mut voyage = Voyage::new("");
        voyage.sail(30, |_| Some(15.0));
        assert_eq!(voyage.sail(300, |_| None), None);
        assert_eq!(voyage.sail(30, |_| Some(15.0)), None);
        assert!(voyage.sail(60, |_| Some(15.0)).is_some());
        assert_eq!(voyage.sail(590, |_| None), None);
        assert!(voyage.is_open());
        assert!(voyage.sail(60, |_| None).is_some());
        assert!(!voyage.is_open());
    }

    #[test]
    fn a_restart_keeps_the_alarm_and_its_acknowledgement() {
        let mut voyage = Voyage::new("");
        voyage.sail(120, |_| Some(15.0));
        let raised = *voyage.monitor.last().unwrap();
        voyage.monitor.acknowledge(raised.id);
        assert!(!voyage.monitor.last().unwrap().is_stored_as(&raised));
        voyage.restart();
        // The instruments are heard after a while.
        assert_eq!(voyage.sail(60, |_| None), None);
        assert_eq!(voyage.sail(600, |_| Some(15.0)), None);
        let kept = voyage.monitor.last().unwrap();
        assert!(kept.is_open && kept.acknowledged && kept.id == raised.id);
        voyage.restart();
        assert!(voyage.sail(60, |_| Some(2.0)).is_some());
        assert!(!voyage.is_open());
        // Nothing is heard after the next restart: it does not stay for ever.
        voyage.sail(60, |_| Some(15.0));
        voyage.restart();
        assert_eq!(voyage.sail(599, |_| None), None);
        assert!(voyage.sail(2, |_| None).is_some());
    }

    #[test]
    fn only_the_alarm_that_was_seen_is_acknowledged() {
        let mut voyage = Voyage::new("");
        voyage.sail(120, |_| Some(15.0));
        let id = voyage.monitor.last().unwrap().id;
        voyage.monitor.acknowledge(Uuid::nil());
        assert!(!voyage.monitor.last().unwrap().acknowledged);
        voyage.monitor.acknowledge(id);
        let status = voyage.monitor.last().unwrap().status();
        assert!(status.alarm.acknowledged);
        assert_eq!(
            status.summary,
            "corrected heading and gyro differ by 15°; the limit is 10°"
        );
    }
}
