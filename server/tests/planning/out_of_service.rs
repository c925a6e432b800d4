//! Vessels out of service: sold or laid up.

use crate::schedule::{due_vessel, enter_port_call, planned_firm, solve, update_schedule};
use binnacle_server_testing::alerts::{set_alert_limits, ship_with_model};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Person, Ship, TestServer, passage};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_vessel_out_of_service_is_unlisted_and_raises_no_alert,
    batches_sent_out_of_service_are_kept_for_the_return,
    a_vessel_with_an_order_under_way_stays_in_service,
    only_its_operators_admin_takes_a_vessel_out_of_service,
    a_vessel_out_of_service_leaves_the_plan_and_comes_back_into_it,
);

const A_WHILE_S: f64 = 10.0;
const LATER: &str = "2026-11-15T12:00:00Z";

async fn set_in_service(person: &Person, vessel: &str, in_service: bool) -> ApiResponse {
    let request = person.request(Method::PATCH, vessel);
    ApiResponse::send(request.json(&json!({ "in_service": in_service }))).await
}

async fn items(person: &Person, path: &str) -> Vec<Value> {
    let listed = person.get(path).await.good();
    listed["items"].as_array().unwrap().clone()
}

/// Enrols a ship with deviation over its limit and a port call ahead.
async fn ship_over_limit(server: &TestServer, person: &Person) -> Ship {
    let nao = ship_with_model(server, person).await;
    set_alert_limits(server, person, &nao, json!({ "deviation_deg": 1.0 })).await;
    let call =
        json!({ "port": "ESBIO", "eta": "2026-12-01T06:00:00Z", "etd": "2026-12-02T18:00:00Z" });
    person.post(&nao.path("/port-calls"), &call).await.good();
    assert_eq!(items(person, "/alerts?open=true").await.len(), 1);
    nao
}

async fn a_vessel_out_of_service_is_unlisted_and_raises_no_alert(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_over_limit(&server, &ada).await;
    let kogge = server.ship(&ada, "Kogge").await;

    let vessel = set_in_service(&ada, &nao.path(""), false).await.good();
    assert!(vessel["out_of_service_at"].is_string(), "{vessel}");
    assert_eq!(
        (&vessel["name"], &vessel["open_alerts"]),
        (&json!("Nao"), &json!(0))
    );
    let cleared = &items(&ada, "/alerts").await[0];
    assert_eq!(cleared["state"], "cleared");
    assert_eq!(cleared["clearing_reason"], "the vessel is out of service");
    let names = async |path: &str| -> Vec<Value> {
        let listed = items(&ada, path).await.into_iter();
        listed.map(|vessel| vessel["name"].clone()).collect()
    };
    assert_eq!(names("/vessels").await, ["Kogge"]);
    assert_eq!(names("/vessels?in_service=false").await, ["Nao"]);
    let fleet = ada.get("/fleet").await.good();
    let glance: Vec<&Value> = fleet["vessels"].as_array().unwrap().iter().collect();
    assert_eq!(glance.len(), 1);
    assert_eq!(glance[0]["name"], "Kogge");
    for path in ["/needs", &nao.path("/needs")] {
        let needs = items(&ada, path).await;
        assert!(
            needs.iter().all(|need| need["vessel_name"] == "Kogge"),
            "{path}: {needs:?}"
        );
    }
    assert_eq!(items(&ada, "/port-calls").await, Vec::<Value>::new());
    assert_eq!(items(&ada, &nao.path("/port-calls")).await.len(), 1);
    ada.get(&nao.path("/deviation")).await.good();

    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.5 })).await;
    server.advance(5.0 * 86_400.0);
    binnacle_fleet::alerts::check_timed(&server.app)
        .await
        .unwrap();
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    // Both agents have been silent.
    let open = items(&ada, "/alerts?open=true").await;
    assert_eq!(open.len(), 1, "{open:?}");
    assert_eq!(open[0]["vessel_name"], "Kogge");
    drop(kogge);
    server.finish().await;
}

async fn batches_sent_out_of_service_are_kept_for_the_return(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_over_limit(&server, &ada).await;
    set_in_service(&ada, &nao.path(""), false).await.good();
    nao.put(2, &passage(LATER, 30)).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    assert_eq!(items(&ada, "/alerts?open=true").await, Vec::<Value>::new());

    let vessel = set_in_service(&ada, &nao.path(""), true).await.good();
    assert_eq!(vessel["out_of_service_at"], Value::Null);
    server.work().await;
    let open = items(&ada, "/alerts?open=true").await;
    assert_eq!(open.len(), 1, "{open:?}");
    assert_eq!(open[0]["cause"], "deviation_over_limit");
    let samples = ada.get(&nao.path("/samples?limit=1000")).await.good();
    assert_eq!(samples["items"].as_array().unwrap().len(), 330);
    assert_eq!(items(&ada, "/vessels").await.len(), 1);
    assert_eq!(items(&ada, "/port-calls").await.len(), 1);
    server.finish().await;
}

async fn a_vessel_with_an_order_under_way_stays_in_service(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let compass = &items(&ada, &nao.path("/compasses")).await[0]["id"];
    let vessel = ada.get(&nao.path("")).await.good()["id"].clone();
    let order = json!({
        "vessel_id": vessel, "compass_id": compass, "port": "ESBIO",
        "planned_at": "2026-12-01T08:00:00Z",
    });
    let made = ada.post("/work-orders", &order).await.good();
    let refused = set_in_service(&ada, &nao.path(""), false).await;
    assert_eq!(
        (refused.status, refused.problem().as_str()),
        (409, "wrong-state")
    );
    let cancel = format!("/work-orders/{}/cancel", made["id"].as_str().unwrap());
    ada.post(&cancel, &json!({ "text": "Sold" })).await.good();
    set_in_service(&ada, &nao.path(""), false).await.good();
    let refused = ada.post("/work-orders", &order).await;
    assert_eq!(
        (refused.status, refused.problem().as_str()),
        (409, "wrong-state")
    );
    server.finish().await;
}

async fn only_its_operators_admin_takes_a_vessel_out_of_service(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let eve = server.admin("eve").await;
    assert_eq!(set_in_service(&eve, &nao.path(""), false).await.status, 404);
    let viewer = ada.viewer(&server).await;
    assert_eq!(
        set_in_service(&viewer, &nao.path(""), false).await.status,
        403
    );
    assert_eq!(
        ada.get(&nao.path("")).await.good()["out_of_service_at"],
        Value::Null
    );
    server.finish().await;
}

async fn a_vessel_out_of_service_leaves_the_plan_and_comes_back_into_it(server: TestServer) {
    let ada = server.admin("ada").await;
    planned_firm(&server, &ada, "rosa").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    let path = format!("/vessels/{}", nao["id"].as_str().unwrap());
    let jobs = async || {
        let seen = ada.get("/schedule").await.good();
        seen["plan"]["jobs"].as_array().unwrap().len()
    };
    solve(&ada).await;
    assert_eq!(jobs().await, 1);
    for (in_service, planned) in [(false, 0), (true, 1)] {
        set_in_service(&ada, &path, in_service).await.good();
        assert_eq!(update_schedule(&server).await, Some(ada.operator));
        assert_eq!(jobs().await, planned);
    }
    server.finish().await;
}
