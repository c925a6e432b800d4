//! Concurrent requests for a schedule.

use super::{due_vessel, enter_port_call, planned_firm};
use binnacle_server_testing::TestServer;
use binnacle_server_testing::on_both;
use serde_json::{Value, json};

on_both!(concurrent_solves_give_one_plan);

async fn concurrent_solves_give_one_plan(server: TestServer) {
    let ada = server.admin("ada").await;
    planned_firm(&server, &ada, "Maas Compass").await;
    for name in ["Nao", "Pinta", "Santa"] {
        let vessel = due_vessel(&ada, name).await;
        enter_port_call(&ada, &vessel, "NLRTM", 8).await;
    }
    let body = json!({});
    let solve = || ada.post("/schedule/solve", &body);
    let (one, two, three, four) = tokio::join!(solve(), solve(), solve(), solve());
    let plans: Vec<Value> = [one, two, three, four]
        .iter()
        .map(|response| response.good()["plan"].clone())
        .collect();
    assert!(plans.iter().all(|plan| plan == &plans[0]), "{plans:?}");
    let list = ada.get("/schedule/plans").await.good();
    assert_eq!(list["items"].as_array().unwrap().len(), 1);
    // The team does one of them on each of the call's two days.
    let days = plans[0]["jobs"].as_array().unwrap().iter();
    let days: Vec<&str> = days.map(|job| job["day"].as_str().unwrap()).collect();
    assert_eq!(days, ["2026-12-08", "2026-12-09"]);
    server.finish().await;
}
