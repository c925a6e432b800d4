//! The compass deviation book.

use binnacle_server_testing::on_both;
use binnacle_server_testing::{Person, TestServer, days_at_sea, true_model};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    the_book_has_an_entry_for_each_watch_and_large_alteration,
    paging_and_filtering_lose_no_entry_of_the_book,
    a_card_is_valid_from_its_making_to_its_withdrawal,
    a_vessel_without_entries_has_an_empty_book,
    an_invalid_range_is_refused_by_field,
);

const FROM: &str = "2026-11-15T00:00:00Z";
const A_WHILE_S: f64 = 10.0;
const DAY_S: f64 = 86_400.0;

fn entries(book: &Value) -> Vec<Value> {
    book["items"].as_array().unwrap().clone()
}

async fn the_book_has_an_entry_for_each_watch_and_large_alteration(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    // Legs of three hours: three of four watches contain an alteration.
    nao.put(1, &days_at_sea(&true_model(), FROM, 2.0))
        .await
        .good();
    server.advance(A_WHILE_S);
    server.work().await;
    let book = entries(&ada.get(&nao.path("/deviation-book")).await.good());
    let of = |occasion: &str| book.iter().filter(|e| e["occasion"] == occasion).count();
    assert_eq!(of("watch"), 12);
    // A leg that ends with its watch has its alteration between two watches.
    assert_eq!(of("alteration"), 12, "{book:?}");
    for entry in &book {
        let degrees = |name: &str| entry[name].as_f64().unwrap();
        let sum = degrees("compass_deg") + degrees("deviation_deg") + degrees("variation_deg");
        let apart = (sum - degrees("true_deg") + 540.0).rem_euclid(360.0) - 180.0;
        assert!(apart.abs() < 1e-6, "{entry}");
        let apart = (degrees("true_deg") - degrees("gyro_deg") + 540.0).rem_euclid(360.0) - 180.0;
        assert!(apart.abs() < 0.5, "{entry}");
        assert_eq!(entry["reference"], "gyro_and_satellite");
        assert_eq!(entry["observer"], "automatic");
        // Everything was observed before there was a model.
        assert_eq!(entry["card_deviation_deg"], json!(null));
    }

    let csv = ada.get(&nao.path("/deviation-book.csv")).await;
    assert_eq!(csv.headers["content-type"], "text/csv; charset=utf-8");
    let lines: Vec<&str> = csv.text.lines().collect();
    assert_eq!(lines.len(), 25);
    assert!(
        lines[0].starts_with("time,occasion,lat,lon,compass_deg"),
        "{}",
        lines[0]
    );
    assert!(
        lines[1].starts_with(&format!("{FROM},watch,47.9")),
        "{}",
        lines[1]
    );

    let pdf = async || {
        let request = ada.request(Method::GET, &nao.path("/deviation-book.pdf"));
        let response = request.send().await.unwrap();
        assert_eq!(response.headers()["content-type"], "application/pdf");
        let name = response.headers()["content-disposition"]
            .to_str()
            .unwrap()
            .to_owned();
        assert_eq!(
            name,
            "inline; filename=\"deviation-book-nao-standard-compass.pdf\"; \
             filename*=UTF-8''deviation-book%20Nao%20Standard%20compass.pdf"
        );
        response.bytes().await.unwrap()
    };
    let printed = pdf().await;
    assert!(printed.starts_with(b"%PDF-1."));
    server.advance(60.0);
    assert!(
        printed == pdf().await,
        "the same book is not the same a minute later"
    );
    server.finish().await;
}

async fn paging_and_filtering_lose_no_entry_of_the_book(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    // Samples are kept in rows of 30 days: one begins on the third.
    nao.put(1, &days_at_sea(&true_model(), "2026-11-01T00:00:00Z", 5.0))
        .await
        .good();
    server.advance(A_WHILE_S);
    server.work().await;
    let whole = entries(&ada.get(&nao.path("/deviation-book")).await.good());
    let mut paged = Vec::new();
    let mut after = String::new();
    loop {
        let page = format!("/deviation-book?limit=7{after}");
        let page = ada.get(&nao.path(&page)).await.good();
        paged.extend(entries(&page));
        let Some(next) = page["next"].as_str() else {
            break;
        };
        after = format!("&after={next}");
    }
    assert_eq!(paged, whole);

    // A range that starts within a watch has the same entries.
    let range = "/deviation-book?from=2026-11-02T01:30:00Z&to=2026-11-03T04:00:00Z";
    let part = entries(&ada.get(&nao.path(range)).await.good());
    let time = |entry: &Value| entry["time"].as_str().unwrap().to_owned();
    let within = |entry: &&Value| {
        let time = time(entry);
        ("2026-11-02T01:30:00Z".."2026-11-03T04:00:00Z").contains(&time.as_str())
    };
    assert_eq!(
        part,
        whole.iter().filter(within).cloned().collect::<Vec<_>>()
    );
    assert!(!part.is_empty() && part.len() < whole.len());
    server.finish().await;
}

async fn a_card_is_valid_from_its_making_to_its_withdrawal(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &days_at_sea(&true_model(), FROM, 5.0))
        .await
        .good();
    server.advance(A_WHILE_S);
    server.work().await;
    // The model is of the 21st; two more days are observed after that.
    server.advance(2.5 * DAY_S);
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    nao.put(2, &days_at_sea(&true_model(), "2026-11-21T08:00:00Z", 2.0))
        .await
        .good();
    server.advance(A_WHILE_S);
    server.work().await;
    let book = entries(&ada.get(&nao.path("/deviation-book")).await.good());
    let models = ada.get(&nao.path("/models")).await.good();
    assert_eq!(models["items"].as_array().unwrap().len(), 2);
    let (with, without): (Vec<_>, Vec<_>) = book
        .iter()
        .partition(|entry| !entry["model_version"].is_null());
    assert!(
        without
            .iter()
            .all(|entry| entry["time"].as_str().unwrap() < "2026-11-20")
    );
    assert!(
        with.iter()
            .all(|entry| entry["time"].as_str().unwrap() > "2026-11-21")
    );
    assert!(with.len() > 12, "{}", with.len());
    for entry in &with {
        // The card of the first model: the second one was made after the last entry.
        assert_eq!(entry["model_version"], 1);
        let degrees = |name: &str| entry[name].as_f64().unwrap();
        let difference = degrees("deviation_deg") - degrees("card_deviation_deg");
        assert!(
            (difference - degrees("difference_deg")).abs() < 1e-9,
            "{entry}"
        );
        assert!(difference.abs() < 1.5, "{entry}");
        assert!(degrees("card_band95_deg") > 0.0);
    }

    let moved = json!({ "kind": "corrector_change", "from": "2026-11-22T12:00:00Z" });
    ada.post(&nao.path("/logbook"), &moved).await.good();
    server.work().await;
    let book = entries(&ada.get(&nao.path("/deviation-book")).await.good());
    for entry in book {
        let time = entry["time"].as_str().unwrap();
        let held = ("2026-11-21".."2026-11-22T12:00:00Z").contains(&time);
        assert_eq!(!entry["model_version"].is_null(), held, "{entry}");
    }
    server.finish().await;
}

async fn a_vessel_without_entries_has_an_empty_book(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let empty = json!({ "items": [], "next": null });
    assert_eq!(ada.get(&nao.path("/deviation-book")).await.good(), empty);
    let csv = ada.get(&nao.path("/deviation-book.csv")).await;
    assert_eq!((csv.status, csv.text.lines().count()), (200, 1));
    let pdf = ada.get(&nao.path("/deviation-book.pdf")).await;
    assert!(pdf.status == 200 && pdf.text.starts_with("%PDF-1."));
    server.finish().await;
}

async fn an_invalid_range_is_refused_by_field(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    for form in ["", ".csv", ".pdf"] {
        for (wrong, problem) in [
            ("?from=yesterday", "invalid"),
            (
                "?from=2026-11-16T00:00:00Z&to=2026-11-15T00:00:00Z",
                "invalid",
            ),
            ("?compass=00000000-0000-0000-0000-000000000000", "not-found"),
            ("?compass=aft", "bad-request"),
        ] {
            let response = ada
                .get(&nao.path(&format!("/deviation-book{form}{wrong}")))
                .await;
            assert_eq!(response.problem(), problem, "{form}{wrong}");
        }
    }
    for cursor in ["x", "9223372036854775807"] {
        let response = ada
            .get(&nao.path(&format!("/deviation-book?after={cursor}")))
            .await;
        assert_eq!(response.problem(), "bad-request", "{cursor}");
    }
    server.finish().await;
}
