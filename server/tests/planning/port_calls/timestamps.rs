//! Port calls from port systems, time by time.

use binnacle_server_testing::port_calls::path;
use binnacle_server_testing::{ApiResponse, Person, TestServer, on_both};
use serde_json::{Value, json};

on_both!(
    a_call_follows_from_arrival_and_departure_and_their_changes,
    what_is_no_time_at_a_berth_changes_nothing,
    a_timestamp_with_mistakes_is_refused_by_field,
);

const IMO_NUMBER: &str = "9074729";

/// Returns the timestamp of an event at a berth in Rotterdam.
fn timestamp(event: &str, at: &str) -> Value {
    json!({
        "vesselIMONumber": IMO_NUMBER, "UNLocationCode": "NLRTM", "portVisitReference": "V42",
        "facilityTypeCode": "BRTH", "eventClassifierCode": "EST",
        "operationsEventTypeCode": event, "eventDateTime": at,
        "publisherRole": "TR", "eventLocation": { "locationName": "Maasvlakte 3" },
    })
}

async fn send(person: &Person, timestamp: &Value) -> ApiResponse {
    person.post("/port-calls/timestamps", timestamp).await
}

async fn effect(person: &Person, timestamp: &Value) -> String {
    let received = send(person, timestamp).await.good();
    received["effect"].as_str().unwrap().to_owned()
}

async fn with_vessel(server: &TestServer) -> (Person, String) {
    let ada = server.admin("ada").await;
    let new = json!({ "name": "Nao", "imo_number": IMO_NUMBER });
    let vessel = ada.post("/vessels", &new).await.good();
    (ada, path(&vessel))
}

async fn calls(person: &Person, path: &str) -> Vec<Value> {
    let listed = person.get(path).await.good();
    listed["items"].as_array().unwrap().clone()
}

async fn a_call_follows_from_arrival_and_departure_and_their_changes(server: TestServer) {
    let (ada, path) = with_vessel(&server).await;
    let arrival = timestamp("ARRI", "2026-12-08T06:00:00Z");
    assert_eq!(effect(&ada, &arrival).await, "awaits_departure");
    assert_eq!(calls(&ada, &path).await.len(), 0);
    let departure = timestamp("DEPA", "2026-12-10T19:00:00+01:00");
    assert_eq!(effect(&ada, &departure).await, "created");
    assert_eq!(effect(&ada, &departure).await, "unchanged");
    let made = calls(&ada, &path).await;
    assert_eq!(made.len(), 1, "{made:?}");
    let about = |field: &str| made[0][field].as_str().unwrap().to_owned();
    assert_eq!(about("reference"), "V42");
    assert_eq!(about("berth"), "Maasvlakte 3");
    assert_eq!(about("source"), "api");
    assert_eq!(about("eta"), "2026-12-08T06:00:00Z");
    assert_eq!(about("etd"), "2026-12-10T18:00:00Z");
    // What a person has added stays.
    let one = format!("{path}/{}", about("id"));
    let uncertain = json!({ "eta_uncertainty_h": 6.0 });
    binnacle_server_testing::patch(&ada, &one, &uncertain)
        .await
        .good();
    let mut later = timestamp("ARRI", "2026-12-08T14:30:00Z");
    later["eventClassifierCode"] = json!("PLN");
    assert_eq!(effect(&ada, &later).await, "amended");
    let amended = ada.get(&one).await.good();
    assert_eq!(amended["eta"], "2026-12-08T14:30:00Z");
    assert_eq!(amended["etd"], "2026-12-10T18:00:00Z");
    assert_eq!(amended["eta_uncertainty_h"], 6.0);
    // A pilot who is not needed is no cancelled call.
    let mut without_pilot = timestamp("CANC", "2026-12-08T14:30:00Z");
    without_pilot["portCallServiceTypeCode"] = json!("PILO");
    assert_eq!(effect(&ada, &without_pilot).await, "not_used");
    assert_eq!(calls(&ada, &path).await.len(), 1);
    let cancelled = timestamp("CANC", "2026-12-08T14:30:00Z");
    assert_eq!(effect(&ada, &cancelled).await, "withdrawn");
    assert_eq!(calls(&ada, &path).await.len(), 0);
    server.finish().await;
}

async fn what_is_no_time_at_a_berth_changes_nothing(server: TestServer) {
    let (ada, path) = with_vessel(&server).await;
    let changed = |field: &str, value: &str| {
        let mut timestamp = timestamp("ARRI", "2026-12-08T06:00:00Z");
        timestamp[field] = json!(value);
        timestamp
    };
    for unused in [
        changed("facilityTypeCode", "PBPL"),
        changed("eventClassifierCode", "REQ"),
        changed("operationsEventTypeCode", "STRT"),
        changed("portCallServiceTypeCode", "PILO"),
    ] {
        assert_eq!(effect(&ada, &unused).await, "not_used", "{unused}");
    }
    let departure = timestamp("DEPA", "2026-12-10T18:00:00Z");
    assert_eq!(effect(&ada, &departure).await, "awaits_arrival");
    assert_eq!(calls(&ada, &path).await.len(), 0);
    server.finish().await;
}

async fn a_timestamp_with_mistakes_is_refused_by_field(server: TestServer) {
    let (ada, path) = with_vessel(&server).await;
    let changed = |field: &str, value: &str| {
        let mut timestamp = timestamp("ARRI", "2026-12-08T06:00:00Z");
        timestamp[field] = json!(value);
        timestamp
    };
    let unknown = send(&ada, &changed("vesselIMONumber", "9321483")).await;
    assert_eq!(unknown.problem(), "not-found");
    // Nobody else's vessel is found by its IMO number.
    let eve = server.admin("eve").await;
    let foreign = send(&eve, &timestamp("ARRI", "2026-12-08T06:00:00Z")).await;
    assert_eq!(foreign.problem(), "not-found");
    for (field, value) in [
        ("UNLocationCode", "Rotterdam"),
        ("eventClassifierCode", "MAYBE"),
        ("operationsEventTypeCode", "SINK"),
        ("eventDateTime", "2026-12-08 06:00"),
    ] {
        let refused = send(&ada, &changed(field, value)).await;
        assert_eq!(refused.problem(), "invalid", "{field}");
        assert!(refused.text.contains(field), "{field}: {}", refused.text);
    }
    // A port must exist, and a stay must not overlap another.
    send(&ada, &timestamp("DEPA", "2026-12-10T18:00:00Z"))
        .await
        .good();
    let nowhere = send(&ada, &changed("UNLocationCode", "NLZZZ")).await;
    assert_eq!(nowhere.problem(), "invalid");
    assert!(nowhere.text.contains("NLZZZ"), "{}", nowhere.text);
    assert_eq!(calls(&ada, &path).await.len(), 0);
    server.finish().await;
}
