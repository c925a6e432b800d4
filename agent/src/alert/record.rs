//! The alert as it is stored on board, and its text for the bridge.

use binnacle_compass::time::Timestamp;
use binnacle_wire::alert::{ShipAlert, ShipAlertState, Suspect};
use serde::{Deserialize, Serialize};

/// The last alert, open or closed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct AlertRecord {
    /// Latest revision.
    pub(crate) alert: ShipAlert,
    /// Acknowledged by an officer.
    pub(crate) acknowledged: bool,
    /// Set once the follow-up revision was made.
    #[serde(rename = "followed")]
    pub(crate) followed_up: bool,
    /// One bit per 10° of reference heading on which compass and reference last disagreed; all bits
    /// where this was not stored.
    #[serde(rename = "parted", default = "all_sectors")]
    pub(crate) departed_sectors: u64,
    /// Limit when the alert was raised, degrees.
    #[serde(rename = "raised_by_deg", default)]
    pub(crate) raised_limit_deg: Option<f64>,
    /// Set once the compass is suspected again after two instruments cleared it.
    #[serde(rename = "is_doubted", default)]
    pub(crate) clearance_revoked: bool,
}

fn all_sectors() -> u64 {
    u64::MAX
}

/// The alert as the page and `status` show it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct AlertStatus {
    #[serde(flatten)]
    pub(crate) alert: ShipAlert,
    pub(crate) acknowledged: bool,
    /// Description of the disagreement.
    #[serde(rename = "says")]
    pub(crate) summary: String,
    /// Advice to the officer; empty once the alert is closed.
    pub(crate) advice: String,
    /// Set while corrected heading and card must not be used.
    #[serde(rename = "is_of_the_compass")]
    pub(crate) suspects_compass: bool,
}

impl AlertRecord {
    /// Returns whether the alert is open.
    pub(crate) fn is_open(&self) -> bool {
        self.alert.state == ShipAlertState::Open
    }

    /// Returns whether the compass must not be steered by while the alert is open: always, unless
    /// the compass and one reference contradict the other reference.
    pub(crate) fn suspects_compass(&self) -> bool {
        self.is_open() && matches!(self.alert.suspect(), Suspect::Compass | Suspect::Unknown)
    }

    /// Returns the alert for the page and `status`.
    pub(crate) fn status(&self) -> AlertStatus {
        AlertStatus {
            alert: self.alert,
            acknowledged: self.acknowledged,
            summary: summary(&self.alert),
            advice: advice(&self.alert).to_owned(),
            suspects_compass: self.suspects_compass(),
        }
    }
}

fn summary(alert: &ShipAlert) -> String {
    let reference = alert.reference();
    let minute = |time: Timestamp| time.to_string().get(..16).map(|t| t.replace('T', " "));
    let (since, at) = (
        minute(alert.since).unwrap_or_default(),
        minute(alert.at).unwrap_or_default(),
    );
    match alert.state {
        ShipAlertState::Open => format!(
            "compass and {reference} parted at {since} UTC, by {:.1}°; their usual errors explain \
             at most {:.1}°",
            alert.departure_deg().abs(),
            alert.limit_deg
        ),
        ShipAlertState::Agree => format!("compass and {reference} agree again since {at} UTC"),
        ShipAlertState::NotJudged => {
            format!("the alert of {since} UTC ended at {at} UTC: that card is no longer in use")
        }
    }
}

fn advice(alert: &ShipAlert) -> &'static str {
    if alert.state != ShipAlertState::Open {
        return "";
    }
    match alert.suspect() {
        Suspect::Compass => {
            "Steer by gyro; the satellite compass confirms it. Do not use the corrected compass \
             or the card. Take an azimuth, and report lightning, a shock or magnetic cargo."
        }
        Suspect::Gyro => {
            "The satellite compass confirms the compass: do not trust the gyro. Check the gyro \
             and its speed and latitude settings, take an azimuth, and steer by what it confirms."
        }
        Suspect::Unknown if alert.gyro_departure_deg.is_none() => {
            "Trust neither until one is proven: take an azimuth, and compare both with a steady \
             course over ground. Check the satellite compass and its antennas. Report lightning, \
             a shock or magnetic cargo."
        }
        Suspect::Satellite => {
            "The gyro confirms the compass: do not trust the satellite compass. Check it and \
             its antennas."
        }
        Suspect::Unknown => {
            "Steer by gyro, but trust neither until one is proven: take an azimuth, and check the \
             gyro and its repeaters. Report lightning, a shock or magnetic cargo."
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use uuid::Uuid;

    fn status(state: ShipAlertState, gyro: Option<f64>, satellite: Option<f64>) -> AlertStatus {
        let at = |text| Timestamp::parse(text).unwrap();
        let alert = ShipAlert {
            id: Uuid::from_u128(1),
            revision: 1,
            state,
            since: at("2026-11-21T07:00:10Z"),
            at: at("2026-11-21T07:05:00Z"),
            gyro_departure_deg: gyro,
            satellite_departure_deg: satellite,
            limit_deg: 3.9,
            model_version: 1,
        };
        let record = AlertRecord {
            alert,
            acknowledged: false,
            followed_up: false,
            departed_sectors: 0,
            raised_limit_deg: None,
            clearance_revoked: false,
        };
        record.status()
    }

    #[test]
    fn it_says_what_is_so_and_what_to_do() {
        let open = status(ShipAlertState::Open, Some(-28.4), None);
        assert!(
            open.summary
                .starts_with("compass and gyro parted at 2026-11-21 07:00 UTC, by 28.4°"),
            "{}",
            open.summary
        );
        for wanted in ["Steer by gyro", "take an azimuth", "check the gyro"] {
            assert!(open.advice.contains(wanted), "{}", open.advice);
        }
    }

    #[test]
    fn a_gyro_that_the_satellite_compass_contradicts_is_not_steered_by() {
        let gyro = status(ShipAlertState::Open, Some(9.0), Some(0.2));
        assert!(gyro.advice.contains("do not trust the gyro"));
        let compass = status(ShipAlertState::Open, Some(9.0), Some(9.2));
        assert!(compass.advice.starts_with("Steer by gyro"));
        let satellite = status(ShipAlertState::Open, Some(0.2), Some(9.0));
        assert!(
            satellite
                .advice
                .contains("do not trust the satellite compass")
        );
    }

    #[test]
    fn nobody_is_sent_to_a_gyro_without_readings() {
        let alone = status(ShipAlertState::Open, None, Some(-7.2));
        assert!(
            alone
                .summary
                .contains("compass and satellite compass parted")
        );
        assert!(!alone.advice.contains("gyro"), "{}", alone.advice);
        assert!(alone.advice.contains("take an azimuth"));
    }

    #[test]
    fn what_is_over_says_so_and_asks_for_nothing() {
        let over = status(ShipAlertState::Agree, Some(0.4), None);
        assert_eq!(
            over.summary,
            "compass and gyro agree again since 2026-11-21 07:05 UTC"
        );
        assert_eq!(over.advice, "");
    }
}
