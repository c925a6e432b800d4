//! Binnacles: shipped types, correctors on board, revisions.

use binnacle_server_testing::binnacles::{binnacle, put};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    shipped_binnacle_types_can_be_read,
    every_revision_of_a_binnacle_is_kept,
    an_exported_binnacle_can_be_imported,
    a_binnacle_repeated_under_its_key_is_one_revision,
    an_invalid_binnacle_is_refused_by_field_and_not_stored,
    a_viewer_can_read_but_not_write_a_binnacle,
    the_fleet_lists_each_compass_with_or_without_its_binnacle,
);

/// Creates a vessel; returns the path of its standard compass's binnacle.
async fn binnacle_path(person: &Person) -> String {
    let vessel = person.create_vessel("Nao").await;
    let id = vessel["id"].as_str().unwrap();
    let compass = vessel["compasses"][0]["id"].as_str().unwrap();
    format!("/vessels/{id}/compasses/{compass}/binnacle")
}

async fn shipped_binnacle_types_can_be_read(server: TestServer) {
    let ada = server.admin("ada").await;
    let list = ada.get("/binnacle-types").await.good();
    let types = list["items"].as_array().unwrap();
    assert!(types.len() >= 2, "{types:?}");
    for known in types {
        let path = format!("/binnacle-types/{}", known["name"].as_str().unwrap());
        let whole = ada.get(&path).await.good();
        assert_eq!(whole["maker"], known["maker"]);
        assert!(whole["fore_and_aft"]["holes"].is_array());
    }
    let none = ada.get("/binnacle-types/nowhere").await;
    assert_eq!(none.problem(), "not-found");
    server.finish().await;
}

async fn every_revision_of_a_binnacle_is_kept(server: TestServer) {
    let ada = server.admin("ada").await;
    let path = binnacle_path(&ada).await;
    assert_eq!(ada.get(&path).await.problem(), "not-found");
    let first = put(&ada, &path, &binnacle()).await.good();
    assert_eq!(
        (&first["revision"], &first["by"]),
        (&json!(1), &json!("ada@example.com"))
    );
    let repeated = put(&ada, &path, &binnacle()).await.good();
    assert_eq!(repeated["revision"], 1, "the same is no other revision");
    let mut moved = binnacle();
    moved["setting"]["athwartship"] =
        json!([{ "hole": 7, "magnet": "200 mm", "count": 1, "red": "port" }]);
    let why = format!("{path}?reason=as+found");
    let second = put(&ada, &why, &moved).await.good();
    assert_eq!(
        (&second["revision"], &second["reason"]),
        (&json!(2), &json!("as found"))
    );
    let page = ada.get(&format!("{path}/revisions?limit=1")).await.good();
    assert_eq!(page["items"][0]["revision"], 2);
    let next = page["next"].as_str().unwrap();
    let page = ada
        .get(&format!("{path}/revisions?after={next}"))
        .await
        .good();
    assert_eq!(
        page["items"][0]["binnacle"]["setting"]["athwartship"],
        json!([])
    );
    assert_eq!(page["next"], Value::Null);
    server.finish().await;
}

async fn an_exported_binnacle_can_be_imported(server: TestServer) {
    let ada = server.admin("ada").await;
    let path = binnacle_path(&ada).await;
    put(&ada, &path, &binnacle()).await.good();
    let file = ada.get(&format!("{path}.json")).await;
    let disposition = file.headers["content-disposition"].to_str().unwrap();
    assert!(disposition.starts_with("attachment"), "{disposition}");
    let repeated = put(&ada, &path, &file.good()).await.good();
    assert_eq!(repeated["revision"], 1);
    server.finish().await;
}

async fn a_binnacle_repeated_under_its_key_is_one_revision(server: TestServer) {
    let ada = server.admin("ada").await;
    let path = binnacle_path(&ada).await;
    let mut other = binnacle();
    other["serial"] = json!("2048");
    let send = |body: Value, key: &'static str| {
        let request = ada
            .request(Method::PUT, &path)
            .header("idempotency-key", key);
        ApiResponse::send(request.json(&body))
    };
    assert_eq!(send(binnacle(), "a").await.good()["revision"], 1);
    assert_eq!(send(other, "b").await.good()["revision"], 2);
    // A repeat that arrives late does not undo a newer revision.
    assert_eq!(send(binnacle(), "a").await.good()["revision"], 2);
    let mut third = binnacle();
    third["serial"] = json!("2049");
    assert_eq!(send(third, "a").await.problem(), "idempotency-key-reused");
    server.finish().await;
}

async fn an_invalid_binnacle_is_refused_by_field_and_not_stored(server: TestServer) {
    let ada = server.admin("ada").await;
    let path = binnacle_path(&ada).await;
    let tray = |hole: u16| json!([{ "hole": hole, "magnet": "200 mm", "count": 1, "red": "port" }]);
    for (pointer, value, named) in [
        (
            "/setting/athwartship",
            tray(99),
            "setting.athwartship[0].hole",
        ),
        ("/type/fore_and_aft/holes", json!([]), "fore_and_aft.holes"),
        ("/type/magnets", json!([]), "magnets"),
        (
            "/aboard/quadrantal",
            json!(["9 inch"]),
            "aboard.quadrantal[0]",
        ),
        ("/version", json!(2), "version"),
        ("/serail", json!("2047"), "serail"),
    ] {
        let mut wrong = binnacle();
        let (parent, name) = pointer.rsplit_once('/').unwrap();
        wrong.pointer_mut(parent).unwrap()[name] = value;
        let response = put(&ada, &path, &wrong).await;
        assert_eq!(
            (response.status, response.problem().as_str()),
            (422, "invalid")
        );
        let detail = response.json()["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains(named), "{pointer}: {detail}");
    }
    assert_eq!(ada.get(&path).await.problem(), "not-found");
    server.finish().await;
}

async fn a_viewer_can_read_but_not_write_a_binnacle(server: TestServer) {
    let ada = server.admin("ada").await;
    let path = binnacle_path(&ada).await;
    put(&ada, &path, &binnacle()).await.good();
    let bob = ada.viewer(&server).await;
    assert_eq!(bob.get(&path).await.good()["revision"], 1);
    assert_eq!(put(&bob, &path, &binnacle()).await.problem(), "forbidden");
    server.finish().await;
}

async fn the_fleet_lists_each_compass_with_or_without_its_binnacle(server: TestServer) {
    let ada = server.admin("ada").await;
    let mut paths = Vec::new();
    for name in ["Nao", "Pinta", "Niña"] {
        let vessel = ada.create_vessel(name).await;
        let id = vessel["id"].as_str().unwrap();
        let compass = vessel["compasses"][0]["id"].as_str().unwrap();
        paths.push((
            format!("/vessels/{id}"),
            format!("/vessels/{id}/compasses/{compass}/binnacle"),
        ));
    }
    put(&ada, &paths[0].1, &binnacle()).await.good();
    let mut fuller = binnacle();
    fuller["aboard"]["magnets"][0]["count"] = json!(16);
    let why = format!("{}?reason=four+were+bought", paths[0].1);
    put(&ada, &why, &fuller).await.good();
    put(&ada, &paths[2].1, &binnacle()).await.good();
    let sold = json!({ "in_service": false });
    let sold = ada.request(Method::PATCH, &paths[2].0).json(&sold);
    ApiResponse::send(sold).await.good();

    let first = ada.get("/binnacles?limit=1").await.good();
    let nao = &first["items"][0];
    assert_eq!(
        (&nao["vessel_name"], &nao["compass_name"]),
        (&json!("Nao"), &json!("Standard compass"))
    );
    let kept = &nao["binnacle"];
    assert_eq!(kept["model"], binnacle()["type"]["model"]);
    assert_eq!(
        (&kept["serial"], &kept["revision"], &kept["reason"]),
        (&json!("2047"), &json!(2), &json!("four were bought"))
    );
    assert_eq!(kept["aboard"]["magnets"][0]["count"], 16);
    let next = first["next"].as_str().unwrap();
    let rest = ada.get(&format!("/binnacles?after={next}")).await.good();
    let rest = rest["items"].as_array().unwrap();
    assert_eq!(rest.len(), 1, "who is out of service is left out: {rest:?}");
    assert_eq!(
        (&rest[0]["vessel_name"], &rest[0]["binnacle"]),
        (&json!("Pinta"), &Value::Null)
    );

    let eve = server.admin("eve").await;
    assert_eq!(eve.get("/binnacles").await.good()["items"], json!([]));
    server.finish().await;
}
