//! Firms, their people, and who sees whom.

use crate::commands::{assert_refused, good, run};
use crate::offers::Trade;
use crate::on_both;
use crate::support::{Answer, Shore};
use binnacle_platform::ids::FirmId;
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_platform_admin_brings_an_operator_and_a_firm_together,
    only_a_platform_admin_manages_operators_and_firms,
    a_firm_that_has_an_order_is_not_parted_with,
    a_name_is_what_it_shows,
    an_operator_sees_the_firms_that_it_works_with,
    a_firm_that_is_entered_twice_under_one_key_is_one,
    an_adjuster_has_no_fleet,
    a_token_that_only_reads_enters_no_firm,
);

fn names(list: &Value) -> Vec<&str> {
    let items = list["items"].as_array().unwrap();
    items
        .iter()
        .map(|item| item["name"].as_str().unwrap())
        .collect()
}

async fn a_platform_admin_brings_an_operator_and_a_firm_together(shore: Shore) {
    let ada = shore.admin("ada").await;
    let root = ada.platform_admin(&shore).await;
    let operators = root.get("/operators").await.good();
    assert_eq!(names(&operators), ["ada"]);
    let operator = operators["items"][0]["id"].as_str().unwrap();
    let new = json!({ "name": " Nervión Compass " });
    let firm = root.post("/firms", &new).await;
    assert_eq!(firm.status, 201);
    let firm = firm.good();
    assert_eq!(firm["name"], "Nervión Compass");
    assert_eq!(names(&ada.get("/firms").await.good()), [""; 0]);
    let between = format!(
        "/operators/{operator}/firms/{}",
        firm["id"].as_str().unwrap()
    );
    for _ in 0..2 {
        let engaged = Answer::of(root.request(Method::PUT, &between)).await;
        assert_eq!(engaged.status, 204, "{engaged:?}");
    }
    assert_eq!(names(&ada.get("/firms").await.good()), ["Nervión Compass"]);
    let dismissed = Answer::of(root.request(Method::DELETE, &between)).await;
    assert_eq!(dismissed.status, 204, "{dismissed:?}");
    assert_eq!(names(&ada.get("/firms").await.good()), [""; 0]);
    let again = Answer::of(root.request(Method::DELETE, &between)).await;
    assert_eq!(again.problem(), "not-found");
    shore.finish().await;
}

async fn a_firm_that_has_an_order_is_not_parted_with(shore: Shore) {
    let trade = Trade::offered(&shore, 2).await;
    let root = trade.ada.platform_admin(&shore).await;
    let part = async |firm: FirmId| {
        let between = format!("/operators/{}/firms/{firm}", trade.ada.operator);
        Answer::of(root.request(Method::DELETE, &between)).await
    };
    let [(asked, rosa), (waits, _)] = &trade.firms[..] else {
        unreachable!("there are two")
    };
    for firm in [asked, waits] {
        let refused = part(*firm).await;
        assert_eq!(refused.problem(), "wrong-state");
        assert!(refused.text.contains("asked for one order"), "{refused:?}");
    }
    trade.post(rosa, "/accept", &json!({})).await.good();
    // Who waits is asked when who has it gives it back.
    for firm in [asked, waits] {
        assert_eq!(part(*firm).await.problem(), "wrong-state");
    }
    let sold = json!({ "text": "sold" });
    trade.post(&trade.ada, "/cancel", &sold).await.good();
    for firm in [asked, waits] {
        assert_eq!(part(*firm).await.status, 204);
    }
    shore.finish().await;
}

async fn a_name_is_what_it_shows(shore: Shore) {
    let ada = shore.admin("ada").await;
    for turned in [
        "Nao \u{202e}tsoC",
        "\u{2066}Nao",
        "Nao\u{200f}",
        "Na\u{2028}o",
    ] {
        let refused = ada.post("/vessels", &json!({ "name": turned })).await;
        assert_eq!(refused.problem(), "invalid", "{turned:?}");
        assert!(refused.text.contains("direction of writing"), "{refused:?}");
    }
    // Of any script, and with what joins its letters.
    for name in ["سفينة", "ספינה", "می\u{200c}خواهم"] {
        let made = ada.post("/vessels", &json!({ "name": name })).await;
        assert_eq!(made.good()["name"], name);
    }
    shore.finish().await;
}

async fn only_a_platform_admin_manages_operators_and_firms(shore: Shore) {
    let ada = shore.admin("ada").await;
    let (firm, rosa) = ada.adjuster(&shore, "rosa").await;
    let new = json!({ "name": "Other" });
    for person in [&ada, &rosa, &ada.viewer(&shore).await] {
        let between = format!("/operators/{}/firms/{firm}", ada.operator);
        let refused = [
            person.get("/operators").await,
            person.get(&format!("/operators/{}", ada.operator)).await,
            person.post("/operators", &new).await,
            person.post("/firms", &new).await,
            Answer::of(person.request(Method::PUT, &between)).await,
            Answer::of(person.request(Method::DELETE, &between)).await,
        ];
        for answer in refused {
            assert_eq!(answer.problem(), "forbidden");
        }
    }
    let root = ada.platform_admin(&shore).await;
    assert_eq!(root.post("/operators", &new).await.status, 201);
    let blank = json!({ "name": "  " });
    assert_eq!(root.post("/firms", &blank).await.problem(), "invalid");
    for nobody in [
        format!("/operators/{firm}/firms/{firm}"),
        format!("/operators/{0}/firms/{0}", ada.operator),
    ] {
        let answer = Answer::of(root.request(Method::PUT, &nobody)).await;
        assert_eq!(answer.problem(), "not-found", "{nobody}");
    }
    shore.finish().await;
}

async fn an_operator_sees_the_firms_that_it_works_with(shore: Shore) {
    let ada = shore.admin("ada").await;
    let eve = shore.admin("eve").await;
    let (firm, rosa) = ada.adjuster(&shore, "rosa").await;
    let (other, _) = eve.adjuster(&shore, "other").await;
    assert_eq!(names(&ada.get("/firms").await.good()), ["rosa"]);
    assert_eq!(names(&eve.get("/firms").await.good()), ["other"]);
    assert_eq!(names(&rosa.get("/firms").await.good()), ["rosa"]);
    let all = ada.platform_admin(&shore).await.get("/firms").await.good();
    assert_eq!(names(&all), ["rosa", "other"]);
    let (path, other) = (format!("/firms/{firm}"), format!("/firms/{other}"));
    assert_eq!(ada.get(&path).await.good()["name"], "rosa");
    assert_eq!(rosa.get(&path).await.good()["name"], "rosa");
    assert_eq!(eve.get(&path).await.problem(), "not-found");
    assert_eq!(rosa.get(&other).await.problem(), "not-found");
    shore.finish().await;
}

async fn a_firm_that_is_entered_twice_under_one_key_is_one(shore: Shore) {
    let ada = shore.admin("ada").await;
    let root = ada.platform_admin(&shore).await;
    let new = json!({ "name": "Nervión Compass" });
    let mut ids = Vec::new();
    for _ in 0..2 {
        let request = root.request(Method::POST, "/firms").json(&new);
        let made = Answer::of(request.header("Idempotency-Key", "1")).await;
        ids.push(made.good()["id"].clone());
    }
    assert_eq!(ids[0], ids[1]);
    assert_eq!(names(&root.get("/firms").await.good()).len(), 1);
    shore.finish().await;
}

async fn an_adjuster_has_no_fleet(shore: Shore) {
    let ada = shore.admin("ada").await;
    let (firm, rosa) = ada.adjuster(&shore, "rosa").await;
    let me = rosa.get("/me").await.good();
    assert_eq!(me["role"], "adjuster");
    assert_eq!(me["firm_id"], firm.to_string());
    assert_eq!(me["firm_name"], "rosa");
    assert_eq!(me["operator_id"], Value::Null);
    let vessel = ada.create_vessel("Nao").await;
    let path = format!("/vessels/{}", vessel["id"].as_str().unwrap());
    for path in ["/vessels", &path, &format!("{path}/model")] {
        assert_eq!(rosa.get(path).await.problem(), "forbidden", "{path}");
    }
    let made = rosa.post("/vessels", &json!({ "name": "Other" })).await;
    assert_eq!(made.problem(), "forbidden");
    shore.finish().await;
}

async fn a_token_that_only_reads_enters_no_firm(shore: Shore) {
    let ada = shore.admin("ada").await;
    let root = ada.platform_admin(&shore).await;
    let token = json!({ "name": "ERP", "scope": "read" });
    let token = root.post("/tokens", &token).await.good()["token"].clone();
    let url = format!("{}/api/v1/firms", shore.url);
    let request = |method| {
        let request = shore.http.request(method, &url);
        request.bearer_auth(token.as_str().unwrap())
    };
    assert_eq!(Answer::of(request(Method::GET)).await.status, 200);
    let new = request(Method::POST).json(&json!({ "name": "Other" }));
    assert_eq!(Answer::of(new).await.problem(), "forbidden");
    shore.finish().await;
}

#[test]
fn admin_creates_a_firm_and_its_adjusters() {
    let folder = tempfile::tempdir().unwrap();
    let create = |more: &[&str]| run(folder.path(), &[&["admin", "create"], more].concat());
    let made = |more: &[&str]| serde_json::from_str::<Value>(&good(&create(more))).unwrap();
    let operator = made(&["operator", "--name", "Nao"])["operator_id"].clone();
    let operator = operator.as_str().unwrap();
    let firm = made(&["firm", "--name", "Compass", "--operator", operator]);
    assert_eq!(firm["operators"], json!([operator]));
    let firm = firm["firm_id"].as_str().unwrap();
    let person = ["--email", "rosa@b.example", "--name", "Rosa"];
    let rosa = made(&[&["adjuster", "--firm", firm], &person[..]].concat());
    assert_eq!(
        (&rosa["role"], &rosa["firm_id"]),
        (&json!("adjuster"), &json!(firm))
    );
    let nobody = "00000000-0000-0000-0000-000000000000";
    let refused = create(&["firm", "--name", "Other", "--operator", nobody]);
    assert_refused(&refused, &["--operator", "does not exist"]);
    let other = ["--email", "other@b.example", "--name", "Other"];
    let refused = create(&[&["adjuster", "--firm", operator], &other[..]].concat());
    assert_refused(&refused, &["--firm", "does not exist"]);
    let refused = create(&[&["adjuster", "--firm", firm], &person[..]].concat());
    assert_refused(&refused, &["--email", "already has an account"]);
}
