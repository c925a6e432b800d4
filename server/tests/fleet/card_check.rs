//! Check of a printed card, by anyone who holds it.

use binnacle_compass::time::Timestamp;
use binnacle_server_testing::alerts::{agent_alert, put_agent_alerts, set_alert_limits};
use binnacle_server_testing::{
    ApiResponse, Engine, Person, Ship, TestServer, days_at_sea, model_after_step, on_both,
    true_model,
};
use binnacle_wire::alert::ShipAlertState;
use serde_json::{Value, json};

on_both!(
    a_card_is_in_force_until_a_change_replaces_it,
    a_check_tells_neither_place_nor_operator,
    a_code_that_the_server_did_not_sign_is_of_no_card,
    a_code_is_good_after_the_key_was_rotated,
    a_card_that_would_not_be_printed_now_cannot_be_confirmed,
    a_card_of_a_withdrawn_model_is_withdrawn,
    a_card_of_a_suspected_compass_is_suspected,
);

const FROM: &str = "2026-11-01T00:00:00Z";
const DAYS: f64 = 10.0;
const A_WHILE_S: f64 = 10.0;

async fn sail(server: &TestServer, ship: &Ship, seq: u64, from: Timestamp, step_nt: f64) {
    let samples = days_at_sea(
        &model_after_step(step_nt, 0.6 * step_nt),
        &from.to_string(),
        DAYS,
    );
    ship.put(seq, &samples).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
}

/// Enrols a ship with a model, and prints her card.
async fn printed(server: &TestServer, ada: &Person) -> (Ship, Value) {
    let nao = server.ship(ada, "Nao <Victoria>").await;
    let samples = days_at_sea(&true_model(), FROM, DAYS);
    nao.put(1, &samples).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let card = ada.get(&nao.path("/card.json")).await.good();
    (nao, card)
}

/// Asks for the check of a code without signing in.
async fn check(server: &TestServer, code: &str) -> ApiResponse {
    let url = format!("{}/api/v1/card-checks/{code}", server.url);
    ApiResponse::send(reqwest::Client::new().get(url)).await
}

fn code(card: &Value) -> &str {
    card["check_code"].as_str().unwrap()
}

async fn a_card_is_in_force_until_a_change_replaces_it(server: TestServer) {
    let ada = server.admin("ada").await;
    let (nao, card) = printed(&server, &ada).await;
    let found = check(&server, code(&card)).await.good();
    assert_eq!(found["state"], "in_force", "{found}");
    assert_eq!(found["vessel_name"], "Nao <Victoria>");
    assert_eq!(found["model_version"], card["model"]["version"]);
    let rows = found["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 24);
    for (row, printed) in rows.iter().zip(card["rows"].as_array().unwrap()) {
        assert_eq!(row["compass_deg"], printed["compass_deg"]);
        let deviation = |row: &Value| row["deviation_deg"].as_f64().unwrap();
        let off = deviation(row) - deviation(printed);
        assert!(off.abs() < 0.051, "{row} {printed}");
    }

    let later = Timestamp::parse(FROM)
        .unwrap()
        .plus_seconds(DAYS * 86_400.0);
    sail(&server, &nao, 2, later, 1500.0).await;
    let found = check(&server, code(&card)).await.good();
    assert_eq!(found["state"], "replaced", "{found}");
    let statement = found["statement"].as_str().unwrap();
    assert!(statement.contains("no longer valid"), "{statement}");
    let newer = ada.get(&nao.path("/card.json")).await.good();
    let found = check(&server, code(&newer)).await.good();
    assert_eq!(found["state"], "in_force", "{found}");
    server.finish().await;
}

async fn a_check_tells_neither_place_nor_operator(server: TestServer) {
    let ada = server.admin("ada").await;
    let (_, card) = printed(&server, &ada).await;
    let found = check(&server, code(&card)).await.good();
    let names: Vec<&str> = found
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    let known = [
        "state",
        "statement",
        "checked_at",
        "vessel_name",
        "imo_number",
        "compass",
        "at",
        "model_version",
        "rows",
        "largest_difference_deg",
    ];
    assert!(names.iter().all(|name| known.contains(name)), "{names:?}");
    let operator = ada.get("/me").await.good()["operator_name"].to_string();
    assert!(
        operator.len() > 4 && !found.to_string().contains(&operator),
        "{found}"
    );
    for place in ["lat", "lon", "h_nt"] {
        let value = card["place"][place].to_string();
        assert!(!found.to_string().contains(&value), "{place} {found}");
    }
    server.finish().await;
}

async fn a_code_that_the_server_did_not_sign_is_of_no_card(server: TestServer) {
    let ada = server.admin("ada").await;
    let (_, card) = printed(&server, &ada).await;
    let code = code(&card);
    // Each letter but the last, whose lowest bits may be none of the code's.
    for place in 0..code.len() - 1 {
        let mut forged: Vec<char> = code.chars().collect();
        forged[place] = if forged[place] == 'A' { 'B' } else { 'A' };
        let forged: String = forged.into_iter().collect();
        let refused = check(&server, &forged).await;
        assert_eq!(refused.status, 404, "{place}: {}", refused.text);
    }
    for odd in ["AAAA", "%00", "....", &code[..40], &format!("{code}{code}")] {
        assert_eq!(check(&server, odd).await.status, 404, "{odd}");
    }
    server.finish().await;
}

async fn a_code_is_good_after_the_key_was_rotated(server: TestServer) {
    let ada = server.admin("ada").await;
    let (nao, card) = printed(&server, &ada).await;
    let mut tx = server.app.db.begin().await.unwrap();
    let now = server.app.clock.now().into();
    binnacle_platform::signing_keys::rotate(&mut tx, now)
        .await
        .unwrap();
    tx.commit().await.unwrap();
    let again = ada.get(&nao.path("/card.json")).await.good();
    assert_ne!(again["check_code"], card["check_code"]);
    for card in [&card, &again] {
        let found = check(&server, code(card)).await.good();
        assert_eq!(found["state"], "in_force", "{found}");
    }
    server.finish().await;
}

/// Checks the state of a card; returns its statement.
async fn statement(server: &TestServer, card: &Value, state: &str) -> String {
    let found = check(server, code(card)).await.good();
    assert_eq!(found["state"], state, "{found}");
    found["statement"].as_str().unwrap().to_owned()
}

async fn a_card_that_would_not_be_printed_now_cannot_be_confirmed(server: TestServer) {
    let ada = server.admin("ada").await;
    let (nao, card) = printed(&server, &ada).await;
    let far = format!("/card.json?lat=20&lon=-40&at={}", "2026-11-12T00:00:00Z");
    let wide = ada.get(&nao.path(&far)).await.good();
    // The vessel's limit is narrower now than the band there.
    let band_deg = wide["widest_band95_deg"].as_f64().unwrap();
    let limit = json!({ "band95_deg": 0.9 * band_deg });
    set_alert_limits(&server, &ada, &nao, limit).await;
    let words = statement(&server, &wide, "unconfirmed").await;
    assert!(words.contains("known only to ±"), "{words}");
    let limit = json!({ "band95_deg": 3.0 });
    set_alert_limits(&server, &ada, &nao, limit).await;
    statement(&server, &wide, "in_force").await;

    server.advance(100.0 * 86_400.0);
    let words = statement(&server, &card, "unconfirmed").await;
    assert!(words.contains("2026-11-10"), "{words}");
    let page = reqwest::get(format!("{}/check/{}", server.url, code(&card)))
        .await
        .unwrap();
    let page = page.text().await.unwrap();
    assert!(page.contains("cannot be confirmed"), "{page}");
    server.finish().await;
}

async fn a_card_of_a_withdrawn_model_is_withdrawn(server: TestServer) {
    let ada = server.admin("ada").await;
    let (nao, card) = printed(&server, &ada).await;
    let moved = json!({ "kind": "corrector_change", "from": "2026-11-11T00:00:00Z" });
    ada.post(&nao.path("/logbook"), &moved).await.good();
    server.work().await;
    let words = statement(&server, &card, "withdrawn").await;
    assert!(words.contains("corrector change"), "{words}");
    server.finish().await;
}

async fn a_card_of_a_suspected_compass_is_suspected(server: TestServer) {
    let ada = server.admin("ada").await;
    let (nao, card) = printed(&server, &ada).await;
    let parted = agent_alert(1, 1, ShipAlertState::Open);
    put_agent_alerts(&nao, 2, Vec::new(), vec![parted]).await;
    let words = statement(&server, &card, "suspected").await;
    assert!(words.contains("Do not rely"), "{words}");
    server.finish().await;
}

#[tokio::test]
async fn the_code_on_the_sheet_leads_to_a_page_that_needs_no_sign_in() {
    let settings = ["--public-url", "https://binnacle.example.com/"];
    let server = TestServer::start_with(Engine::Sqlite, &settings).await;
    let ada = server.admin("ada").await;
    let (_, card) = printed(&server, &ada).await;
    let url = card["check_url"].as_str().unwrap();
    let path = url.strip_prefix("https://binnacle.example.com").unwrap();
    assert_eq!(path, format!("/check/{}", code(&card)));
    let page = reqwest::get(format!("{}{path}", server.url)).await.unwrap();
    assert_eq!(page.status(), 200);
    let page = page.text().await.unwrap();
    assert!(page.contains("This card is in force."), "{page}");
    assert!(page.contains("Nao &lt;Victoria&gt;"), "{page}");
    assert!(!page.contains("<script"), "{page}");
    let forged = reqwest::get(format!("{}/check/AAAA", server.url))
        .await
        .unwrap();
    assert_eq!(forged.status(), 404);
    assert!(forged.text().await.unwrap().contains("not valid"));
    server.finish().await;
}
