//! Alert of GNSS interference: open while fixes are heard and no receiver is trusted.

use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use binnacle_instruments::Interference;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// The last interference, open or over.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct InterferenceAlert {
    pub(crate) id: Uuid,
    #[serde(skip)]
    pub(crate) is_open: bool,
    pub(crate) acknowledged: bool,
    /// Start, by GNSS time; none if that was not known.
    pub(crate) since: Option<Timestamp>,
    /// Last place that was trusted.
    pub(crate) place: Position,
}

/// Open alert as the page and `status` show it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct InterferenceStatus {
    #[serde(flatten)]
    pub(crate) alert: InterferenceAlert,
    /// Description of the interference.
    #[serde(rename = "says")]
    pub(crate) summary: String,
    /// Advice to the officer.
    pub(crate) advice: String,
}

/// State between two seconds.
#[derive(Debug, Default)]
pub(crate) struct InterferenceMonitor {
    last: Option<InterferenceAlert>,
}

impl InterferenceMonitor {
    /// Applies the guard's finding. Returns whether the alert was raised or is over.
    pub(crate) fn observe(
        &mut self,
        found: Option<Interference>,
        new_id: impl FnOnce() -> Uuid,
    ) -> bool {
        let open = self.last.as_mut().filter(|last| last.is_open);
        match (found, open) {
            (Some(found), None) => {
                self.last = Some(InterferenceAlert {
                    id: new_id(),
                    is_open: true,
                    acknowledged: false,
                    since: found.since,
                    place: found.place,
                });
                true
            }
            (None, Some(open)) => {
                open.is_open = false;
                true
            }
            _ => false,
        }
    }

    /// Returns the last alert, open or over.
    pub(crate) fn last(&self) -> Option<&InterferenceAlert> {
        self.last.as_ref()
    }

    /// Returns the open alert.
    pub(crate) fn status(&self) -> Option<InterferenceStatus> {
        let open = self.last.filter(|last| last.is_open);
        open.map(InterferenceAlert::status)
    }

    /// Marks the alert as acknowledged by an officer.
    pub(crate) fn acknowledge(&mut self, id: Uuid) {
        if let Some(alert) = self.last.as_mut().filter(|alert| alert.id == id) {
            alert.acknowledged = true;
        }
    }
}

impl InterferenceAlert {
    /// Returns the alert as the page and `status` show it.
    pub(crate) fn status(self) -> InterferenceStatus {
        let since = self.since.map_or(String::new(), |since| {
            since
                .to_chrono()
                .format(" since %d %b %H:%M UTC")
                .to_string()
        });
        InterferenceStatus {
            alert: self,
            summary: format!(
                "GNSS interference{since}: position, speed and satellite compass are not used; the \
                 heading is corrected for the reckoned place"
            ),
            advice: "Navigate without GNSS: its position, speed and time may be false. Fix the \
                     position by radar and bearings."
                .to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_interference_is_an_alert_of_its_own_until_it_passes() {
        let mut monitor = InterferenceMonitor::default();
        let found = Some(Interference {
            since: Timestamp::parse("2026-11-21T07:04:00Z").ok(),
            place: Position::new(36.0, 15.0).unwrap(),
        });
        let first = Uuid::from_u128(1);
        assert!(!monitor.observe(None, || first));
        assert!(monitor.observe(found, || first));
        assert!(!monitor.observe(found, || Uuid::from_u128(2)));
        monitor.acknowledge(first);
        let status = monitor.status().unwrap();
        assert!(status.alert.acknowledged);
        let said = "GNSS interference since 21 Nov 07:04 UTC: ";
        assert!(status.summary.starts_with(said), "{}", status.summary);
        assert!(monitor.observe(None, || first));
        assert_eq!(monitor.status(), None);
        assert!(monitor.observe(found, || Uuid::from_u128(3)));
        assert!(!monitor.last().unwrap().acknowledged);
    }
}
