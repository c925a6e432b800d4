//! Rules for all requests: query, mistakes in the body, rate, versions, and the form of files.

use binnacle_server_testing::offers::OfferParties;
use binnacle_server_testing::port_calls::{call, path};
use binnacle_server_testing::{ApiResponse, Engine, PASSWORD, Person, TestServer, on_both};
use reqwest::Method;
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

on_both!(
    a_query_parameter_that_does_not_exist_is_refused_by_name,
    all_mistakes_of_a_body_are_listed_with_pointers,
    a_change_of_what_another_person_changed_meanwhile_is_refused,
    a_csv_file_has_the_form_that_a_spreadsheet_expects,
    a_file_keeps_the_vessels_name,
    a_repeated_request_for_a_secret_makes_nothing_more,
    orders_and_alerts_are_listed_by_their_time,
);

async fn a_query_parameter_that_does_not_exist_is_refused_by_name(server: TestServer) {
    let ada = server.admin("ada").await;
    ada.create_vessel("Nao").await;
    let refused = ada.get("/vessels?in_servise=true").await;
    assert_eq!(
        (refused.status, refused.problem().as_str()),
        (400, "bad-request")
    );
    let detail = refused.json()["detail"].as_str().unwrap().to_owned();
    assert!(detail.contains("\"in_servise\""), "{detail}");
    assert!(detail.contains("in_service, limit, after"), "{detail}");
    ada.get("/vessels?in_service=true").await.good();
    let change = ada.request(Method::POST, "/vessels?dry_run=true");
    let refused = ApiResponse::send(change.json(&json!({ "name": "Kogge" }))).await;
    assert_eq!(refused.problem(), "bad-request");
    let listed = ada.get("/vessels").await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 1);
    server.finish().await;
}

async fn all_mistakes_of_a_body_are_listed_with_pointers(server: TestServer) {
    let ada = server.admin("ada").await;
    let vessel = ada.create_vessel("Nao").await;
    let mistaken = json!({
        "eta": "tomorrow", "etd": 7, "berth": "x".repeat(201), "eta_uncertainty_h": -1.0,
    });
    let refused = ada.post(&path(&vessel), &mistaken).await;
    assert_eq!(refused.problem(), "invalid");
    let errors = refused.json()["errors"].clone();
    let mut pointers: Vec<&str> = errors
        .as_array()
        .unwrap()
        .iter()
        .map(|error| error["pointer"].as_str().unwrap())
        .collect();
    pointers.sort_unstable();
    for pointer in ["/etd", "/port"] {
        assert!(pointers.contains(&pointer), "{pointer}: {errors}");
    }
    assert!(!pointers.contains(&""), "{errors}");
    // A value that only its handler can judge has its pointer too.
    let wrong = json!({ "name": "Nao", "imo_number": "9074728" });
    let refused = ada.post("/vessels", &wrong).await.json();
    assert_eq!(refused["errors"][0]["pointer"], "/imo_number");
    assert_eq!(refused["errors"].as_array().unwrap().len(), 1, "{refused}");
    // What cannot be read at all has no places.
    let broken = ada.request(Method::POST, "/vessels").body("{");
    let broken = ApiResponse::send(broken.header("content-type", "application/json")).await;
    assert_eq!(broken.problem(), "bad-request");
    assert_eq!(broken.json()["errors"], Value::Null);
    server.finish().await;
}

/// Returns the version of what a path shows.
async fn version(person: &Person, path: &str) -> String {
    let shown = person.get(path).await;
    shown.headers["etag"].to_str().unwrap().to_owned()
}

async fn change(
    person: &Person,
    method: Method,
    path: &str,
    body: &Value,
    of: &str,
) -> ApiResponse {
    let request = person.request(method, path).header("if-match", of);
    ApiResponse::send(request.json(body)).await
}

async fn a_change_of_what_another_person_changed_meanwhile_is_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    let vessel = ada.create_vessel("Nao").await;
    let of_vessel = format!("/vessels/{}", vessel["id"].as_str().unwrap());
    let stay = ada.post(&path(&vessel), &call("NLRTM", 8)).await.good();
    let of_call = format!("{}/{}", path(&vessel), stay["id"].as_str().unwrap());
    let lightning = json!({ "kind": "lightning", "from": "2026-11-01T00:00:00Z" });
    let logbook = format!("{of_vessel}/logbook");
    let entry = ada.post(&logbook, &lightning).await.good();
    let of_entry = format!("{logbook}/{}", entry["id"].as_str().unwrap());
    let settings = ada.get(&format!("{of_vessel}/settings")).await.good();
    let changed = |analysis_sd: f64| {
        let mut changed = settings.clone();
        changed["analysis"]["reference_constant_sd_deg"] = json!(analysis_sd);
        changed
    };
    let tonnage = |gross_tonnage: u32| json!({ "gross_tonnage": gross_tonnage, "transits": [] });
    for (method, path, first, second) in [
        (
            Method::PATCH,
            of_vessel.clone(),
            json!({ "flag": "PA" }),
            json!({ "flag": "LR" }),
        ),
        (
            Method::PATCH,
            of_call,
            json!({ "berth": "A5" }),
            json!({ "berth": "A6" }),
        ),
        (
            Method::PATCH,
            of_entry,
            json!({ "note": "one" }),
            json!({ "note": "two" }),
        ),
        (
            Method::PUT,
            format!("{of_vessel}/settings"),
            changed(1.5),
            changed(2.5),
        ),
        (
            Method::PUT,
            format!("{of_vessel}/particulars"),
            tonnage(900),
            tonnage(800),
        ),
    ] {
        let read = version(&ada, &path).await;
        assert_eq!(read, version(&ada, &path).await, "{path}");
        let done = change(&ada, method.clone(), &path, &first, &read).await;
        done.good();
        let now = version(&ada, &path).await;
        assert_eq!(done.headers["etag"].to_str().unwrap(), now, "{path}");
        let before = ada.get(&path).await.good();
        let late = change(&ada, method.clone(), &path, &second, &read).await;
        assert_eq!(
            (late.status, late.problem().as_str()),
            (412, "changed"),
            "{path}"
        );
        assert_eq!(ada.get(&path).await.good(), before, "{path}");
        change(&ada, method.clone(), &path, &second, &now)
            .await
            .good();
        // Without a version a change applies to any, as ever.
        let request = ada.request(method, &path).json(&first);
        ApiResponse::send(request).await.good();
    }
    let senseless = change(&ada, Method::PATCH, &of_vessel, &json!({}), "7").await;
    assert_eq!(senseless.problem(), "bad-request");
    server.finish().await;
}

async fn a_csv_file_has_the_form_that_a_spreadsheet_expects(server: TestServer) {
    let ada = server.admin("ada").await;
    let vessel = ada.create_vessel("Nao").await;
    let mut stay = call("NLRTM", 8);
    stay["berth"] = json!("Köln, 5");
    stay["berth_heading_deg"] = json!(45.5);
    ada.post(&path(&vessel), &stay).await.good();
    let file = async |query: &str| ada.get(&format!("{}.csv{query}", path(&vessel))).await.text;
    let plain = file("").await;
    assert!(
        plain.contains("\"Köln, 5\"") && plain.contains(",45.5"),
        "{plain}"
    );
    let european = file("?separator=semicolon&decimal=comma").await;
    assert!(
        european.contains(";Köln, 5;") && european.contains(";45,5"),
        "{european}"
    );
    // A client that decodes text would take the mark away.
    let marked = ada.request(Method::GET, &format!("{}.csv?bom=true", path(&vessel)));
    let marked = marked.send().await.unwrap().bytes().await.unwrap();
    assert_eq!(
        marked.strip_prefix("\u{feff}".as_bytes()),
        Some(plain.as_bytes())
    );
    assert!(file("?separator=tab").await.contains("\tKöln, 5\t"));
    let unknown = ada
        .get(&format!("{}.csv?separator=pipe", path(&vessel)))
        .await;
    assert_eq!(unknown.problem(), "bad-request");
    server.finish().await;
}

async fn a_file_keeps_the_vessels_name(server: TestServer) {
    let ada = server.admin("ada").await;
    let vessel = ada.create_vessel("Ærø 船").await;
    let file = ada.get(&format!("{}.csv", path(&vessel))).await;
    assert_eq!(
        file.headers["content-disposition"].to_str().unwrap(),
        "inline; filename=\"port-calls-r.csv\"; \
         filename*=UTF-8''port%20calls%20%C3%86r%C3%B8%20%E8%88%B9.csv"
    );
    server.finish().await;
}

async fn a_repeated_request_for_a_secret_makes_nothing_more(server: TestServer) {
    let ada = server.admin("ada").await;
    let vessel = ada.create_vessel("Nao").await;
    let agents = format!("/vessels/{}/agents", vessel["id"].as_str().unwrap());
    let person = json!({ "email": "eve@example.com", "name": "Eve", "role": "viewer" });
    for (path, body) in [
        ("/tokens", json!({ "name": "office", "scope": "read" })),
        ("/calendar-feeds", json!({ "name": "Our fleet" })),
        ("/users", person),
        (agents.as_str(), json!({})),
    ] {
        let create = async |key: &str, body: &Value| {
            let request = ada
                .request(Method::POST, path)
                .header("idempotency-key", key);
            ApiResponse::send(request.json(body)).await
        };
        let key = format!("key of {path}");
        assert_eq!(create(&key, &body).await.status, 201, "{path}");
        let repeated = create(&key, &body).await;
        assert_eq!(
            (repeated.status, repeated.problem().as_str()),
            (409, "shown-once"),
            "{path}"
        );
    }
    let tokens = ada.get("/tokens").await.good();
    assert_eq!(tokens["items"].as_array().unwrap().len(), 1, "{tokens}");
    let feeds = ada.get("/calendar-feeds").await.good();
    assert_eq!(feeds["items"].as_array().unwrap().len(), 1, "{feeds}");
    server.finish().await;
}

async fn orders_and_alerts_are_listed_by_their_time(server: TestServer) {
    let parties = OfferParties::planned(&server, 0).await;
    let count = async |query: &str| {
        let listed = parties.ada.get(query).await.good();
        listed["items"].as_array().unwrap().len()
    };
    // The job is on 22 November at 08:00.
    for (query, orders) in [
        ("from=2026-11-22T08:00:00Z", 1),
        ("from=2026-11-22T08:00:01Z", 0),
        ("to=2026-11-22T08:00:00Z", 0),
        ("to=2026-11-22T09:00:00%2B01:00", 0),
        ("to=2026-11-22T08:00:01Z", 1),
    ] {
        assert_eq!(
            count(&format!("/work-orders?{query}")).await,
            orders,
            "{query}"
        );
    }
    let day = parties.ada.get("/work-orders?from=22.11.2026").await;
    assert_eq!(day.problem(), "invalid");
    assert_eq!(day.json()["errors"][0]["pointer"], "/from");
    assert_eq!(count("/alerts?from=2026-01-01T00:00:00Z").await, 0);
    server.finish().await;
}

#[tokio::test]
async fn a_caller_beyond_the_rate_waits_and_others_do_not() {
    let few = ["--requests-per-minute", "20"];
    let server = TestServer::start_with(Engine::Sqlite, &few).await;
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let first = ada.get("/vessels").await;
    first.good();
    let header =
        |response: &ApiResponse, name: &str| response.headers[name].to_str().unwrap().to_owned();
    assert_eq!(header(&first, "ratelimit-policy"), "\"caller\";q=20;w=60");
    assert!(header(&first, "ratelimit").starts_with("\"caller\";r=19;t="));
    let mut last = first;
    for _ in 0..20 {
        last = ada.get("/vessels").await;
    }
    assert_eq!(
        (last.status, last.problem().as_str()),
        (429, "too-many-requests")
    );
    assert!(header(&last, "ratelimit").starts_with("\"caller\";r=0;t="));
    let wait_s: f64 = header(&last, "retry-after").parse().unwrap();
    assert!((1.0..=60.0).contains(&wait_s), "{wait_s}");
    eve.get("/vessels").await.good();
    server.advance(wait_s);
    ada.get("/vessels").await.good();
    server.finish().await;
}

#[tokio::test]
async fn a_request_has_one_host() {
    let server = TestServer::start(Engine::Sqlite).await;
    let address = server.url.trim_start_matches("http://").to_owned();
    for (hosts, status) in [
        ("Host: one.example\r\n", "HTTP/1.1 200"),
        ("Host: one.example\r\nHost: two.example\r\n", "HTTP/1.1 400"),
        ("Host: one.example\r\nhost: one.example\r\n", "HTTP/1.1 400"),
        ("", "HTTP/1.1 400"),
    ] {
        let mut stream = TcpStream::connect(&address).await.unwrap();
        let request = format!("GET /healthz HTTP/1.1\r\n{hosts}Connection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).await.unwrap();
        let mut response = String::new();
        stream.read_to_string(&mut response).await.unwrap();
        assert!(response.starts_with(status), "{hosts:?}: {response}");
    }
    server.finish().await;
}

#[tokio::test]
async fn a_page_has_at_least_one_item_and_at_most_ten_thousand() {
    let server = TestServer::start(Engine::Sqlite).await;
    let ada = server.admin("ada").await;
    for limit in ["0", "10001", "-1", "1.5", "99999999999"] {
        let refused = ada.get(&format!("/vessels?limit={limit}")).await;
        assert_eq!(refused.problem(), "bad-request", "{limit}");
    }
    for limit in [1, 10_000] {
        ada.get(&format!("/vessels?limit={limit}")).await.good();
    }
    server.finish().await;
}

#[tokio::test]
async fn a_list_in_place_of_an_object_is_refused() {
    let server = TestServer::start(Engine::Sqlite).await;
    let ada = server.admin("ada").await;
    let listed = ada.post("/tokens", &json!(["ERP", "read", null])).await;
    assert_eq!((listed.status, listed.problem().as_str()), (422, "invalid"));
    let pointers = listed.json()["errors"][0]["pointer"].clone();
    assert_eq!(pointers, "");
    let sign_in = server.http.post(format!("{}/api/v1/session", server.url));
    let sign_in = sign_in.json(&json!([ada.email, PASSWORD, null]));
    assert_eq!(ApiResponse::send(sign_in).await.problem(), "invalid");
    // A missing sign-in comes before what is wrong with the body.
    let nobody = server.http.post(format!("{}/api/v1/tokens", server.url));
    let nobody = nobody.json(&json!(["ERP", "read", null]));
    assert_eq!(ApiResponse::send(nobody).await.problem(), "unauthenticated");
    assert_eq!(ada.get("/tokens").await.good()["items"], json!([]));
    server.finish().await;
}

#[tokio::test]
async fn invented_tokens_do_not_escape_the_rate() {
    let few = ["--requests-per-minute", "20"];
    let server = TestServer::start_with(Engine::Sqlite, &few).await;
    let ada = server.admin("ada").await;
    let mut last = 401;
    for number in 0..20 {
        let request = server.http.get(format!("{}/api/v1/vessels", server.url));
        let request = match number % 2 {
            0 => request.bearer_auth(format!("bna_invented{number}")),
            _ => request.header("cookie", format!("binnacle_session=invented{number}")),
        };
        last = ApiResponse::send(request).await.status;
    }
    assert_eq!(last, 429);
    ada.get("/vessels").await.good();
    server.finish().await;
}

#[tokio::test]
async fn a_refusal_of_who_is_not_signed_in_names_the_way_to_sign_in() {
    let server = TestServer::start(Engine::Sqlite).await;
    let url = format!("{}/api/v1/vessels", server.url);
    let refused = ApiResponse::send(server.http.get(url)).await;
    assert_eq!(refused.problem(), "unauthenticated");
    assert_eq!(
        refused.headers["www-authenticate"],
        "Bearer realm=\"Binnacle\""
    );
    server.finish().await;
}
