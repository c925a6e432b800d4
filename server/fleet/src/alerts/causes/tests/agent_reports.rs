//! Alerts from the ship's agent.

use crate::alerts::causes::{AgentReports, Facts, evaluate};
use crate::alerts::desired::DesiredAlert;
use binnacle_compass::time::Timestamp;
use binnacle_platform::severity::Severity;
use binnacle_wire::alert::{ShipAlert, ShipAlertState};
use uuid::Uuid;

fn said(gyro: Option<f64>, satellite: Option<f64>) -> DesiredAlert {
    let at = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
    let report = ShipAlert {
        id: Uuid::from_u128(1),
        revision: 1,
        state: ShipAlertState::Open,
        since: at,
        at,
        gyro_departure_deg: gyro,
        satellite_departure_deg: satellite,
        limit_deg: 4.0,
        model_version: 7,
    };
    let found = evaluate(Facts::AgentReports(&AgentReports {
        reports: &[report],
        known: None,
        until: None,
    }));
    found.into_iter().next().unwrap()
}

#[test]
fn it_is_as_bad_as_it_is_large_and_names_what_is_suspect() {
    let compass = said(Some(-28.4), Some(-27.9));
    assert_eq!(compass.severity, Severity::Critical);
    assert_eq!(
        compass.summary,
        "Compass and gyro parted by 28°, reported by the ship's agent."
    );
    assert!(compass.advice.starts_with("Steer by gyro:"));
    assert_eq!(
        compass.evidence.0[0],
        "The corrected compass less the gyro is -28.4°."
    );
    // The page on board says 6° too.
    let smaller = said(Some(-6.2), Some(-7.2));
    assert!(smaller.summary.starts_with("Compass and gyro parted by 6°"));
    let alone = said(None, Some(-7.2));
    assert!(
        alone
            .summary
            .starts_with("Compass and satellite compass parted by 7°")
    );
    assert!(!alone.advice.contains("gyro"), "{}", alone.advice);
    let gyro = said(Some(6.0), Some(0.3));
    assert_eq!(gyro.severity, Severity::Warning);
    assert!(gyro.advice.contains("have the gyro"));
}
