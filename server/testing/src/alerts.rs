//! Alerts: raised by a limit, and reported by an agent.

use crate::person::{ApiResponse, Person};
use crate::server::TestServer;
use crate::ship::{Ship, passage};
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_wire::alert::{ShipAlert, ShipAlertState};
use binnacle_wire::batch::Batch;
use reqwest::Method;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use uuid::Uuid;

const DAY: &str = "2026-11-15T00:00:00Z";
const AGENT_DAY: &str = "2026-11-20T00:00:00Z";
const A_WHILE_S: f64 = 10.0;

/// Sets the vessel's alert limits and runs its analysis.
pub async fn set_alert_limits(server: &TestServer, person: &Person, ship: &Ship, limits: Value) {
    let mut settings = person.get(&ship.path("/settings")).await.good();
    settings["alerts"] = limits;
    let request = person.request(Method::PUT, &ship.path("/settings"));
    ApiResponse::send(request.json(&settings)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
}

/// Enrols a ship with a model whose largest deviation is between 3 and 12 degrees.
pub async fn ship_with_model(server: &TestServer, person: &Person) -> Ship {
    let ship = server.ship(person, "Nao").await;
    set_alert_limits(server, person, &ship, json!({ "deviation_deg": 45.0 })).await;
    ship.put(1, &passage(DAY, 300)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    ship
}

/// An alert of the agent: the compass departs from the gyro.
pub fn agent_alert(id: u128, revision: u32, state: ShipAlertState) -> ShipAlert {
    let since = Timestamp::parse("2026-11-20T04:00:00Z").unwrap();
    ShipAlert {
        id: Uuid::from_u128(id),
        revision,
        state,
        since,
        at: since.plus_seconds(1800.0 * f64::from(revision) + id as f64),
        gyro_departure_deg: Some(-28.4),
        satellite_departure_deg: None,
        limit_deg: 3.9,
        model_version: 2,
    }
}

/// Sends a batch with samples and alerts of the agent.
pub async fn put_agent_alerts(ship: &Ship, seq: u64, samples: Vec<Sample>, alerts: Vec<ShipAlert>) {
    let batch = Batch {
        stream: ship.stream,
        seq,
        samples,
        tally: BTreeMap::new(),
        alerts,
        thinned: None,
    };
    let bytes = binnacle_wire::encode(&batch).unwrap();
    ship.put_bytes(seq, bytes).await.good();
}

/// Sends an alert of the agent: the compass departs from the gyro.
pub async fn report_departure(ship: &Ship) {
    let id = Uuid::parse_str(&ship.id).unwrap().as_u128();
    let mut open = agent_alert(1, 1, ShipAlertState::Open);
    open.id = Uuid::from_u128(id);
    put_agent_alerts(ship, 1, passage(AGENT_DAY, 6), vec![open]).await;
}

/// Sends the same alert in a batch without samples.
pub async fn report_departure_without_samples(ship: &Ship, seq: u64) {
    let open = agent_alert(1, 1, ShipAlertState::Open);
    put_agent_alerts(ship, seq, Vec::new(), vec![open]).await;
}
