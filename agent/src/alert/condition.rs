//! The agent's alerts as bridge alert management sees them: whether the condition holds, whether it
//! was acknowledged, and short texts in capitals.

use super::heading_difference::{DifferenceReference, HeadingDifference};
use super::interference::InterferenceAlert;
use super::record::AlertRecord;
use binnacle_output::AlertCondition;
use binnacle_wire::alert::Suspect;

impl From<&AlertRecord> for AlertCondition {
    fn from(record: &AlertRecord) -> AlertCondition {
        let alert = &record.alert;
        let suspect = alert.suspect();
        let title = match suspect {
            Suspect::Compass | Suspect::Unknown => "COMPASS SUSPECT",
            Suspect::Gyro => "GYRO SUSPECT",
            Suspect::Satellite => "SAT COMP SUSPECT",
        };
        let description = match suspect {
            Suspect::Compass => "STEER BY GYRO. DO NOT USE THE CARD.",
            Suspect::Gyro => "COMPASS AND SATELLITE COMPASS CONTRADICT.",
            Suspect::Satellite => "COMPASS AND GYRO CONTRADICT.",
            Suspect::Unknown if alert.gyro_departure_deg.is_none() => {
                "SATELLITE COMPASS DIFFERS. TAKE AN AZIMUTH"
            }
            Suspect::Unknown => "COMPASS AND GYRO DIFFER. TAKE AN AZIMUTH.",
        };
        AlertCondition {
            id: alert.id,
            is_active: record.is_open(),
            is_acknowledged: record.acknowledged,
            title,
            description: description.to_owned(),
        }
    }
}

impl From<&HeadingDifference> for AlertCondition {
    fn from(alarm: &HeadingDifference) -> AlertCondition {
        let reference = match alarm.reference {
            DifferenceReference::Gyro => "GYRO",
            DifferenceReference::SatelliteCompass => "SAT COMPASS",
        };
        AlertCondition {
            id: alarm.id,
            is_active: alarm.is_open,
            is_acknowledged: alarm.acknowledged,
            title: "HDG DIFFERENCE",
            description: format!(
                "COMPASS AND {reference} DIFFER OVER {} DEG",
                alarm.limit_deg
            ),
        }
    }
}

impl From<&InterferenceAlert> for AlertCondition {
    fn from(alert: &InterferenceAlert) -> AlertCondition {
        AlertCondition {
            id: alert.id,
            is_active: alert.is_open,
            is_acknowledged: alert.acknowledged,
            title: "GNSS NOT TRUSTED",
            description: "INTERFERENCE. DO NOT USE GNSS POSITION.".to_owned(),
        }
    }
}
