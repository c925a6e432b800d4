//! Files of port calls: imported whole or not at all.

use super::listed;
use binnacle_server_testing::on_both;
use binnacle_server_testing::port_calls::{call, path};
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_csv_sent_repeatedly_is_imported_once,
    a_csv_with_past_port_calls_is_imported,
    a_csv_of_a_european_spreadsheet_is_imported,
    a_csv_with_one_invalid_line_changes_nothing,
    a_replacing_file_withdraws_missing_port_calls,
    a_csv_of_the_fleet_names_vessels_by_number_name_or_id,
    a_calendar_is_imported_and_its_cancellations_withdraw,
    a_file_of_fifty_megabytes_is_refused_with_a_problem,
    an_exported_file_can_be_imported,
    a_file_may_name_only_ones_own_vessels,
);

const HEADER: &str = "id,port,eta,etd,berth\n";

async fn import(person: &Person, path: &str, text: impl Into<String>) -> ApiResponse {
    let request = person.request(Method::POST, path).body(text.into());
    ApiResponse::send(request.header("content-type", "text/csv")).await
}

fn import_counts(created: u32, amended: u32, unchanged: u32, withdrawn: u32, over: u32) -> Value {
    json!({ "created": created, "amended": amended, "unchanged": unchanged,
            "withdrawn": withdrawn, "over": over })
}

fn row(id: &str, port: &str, day: u32) -> String {
    let call = call(port, day);
    let at = |field: &str| call[field].as_str().unwrap().to_owned();
    format!("{id},{port},{},{},A5\n", at("eta"), at("etd"))
}

async fn a_csv_sent_repeatedly_is_imported_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    let csv = format!("{}.csv", path(&nao));
    let file = format!("{HEADER}{}{}", row("a", "NLRTM", 8), row("b", "BEANR", 10));
    assert_eq!(
        import(&ada, &csv, &file).await.good(),
        import_counts(2, 0, 0, 0, 0)
    );
    assert_eq!(
        import(&ada, &csv, &file).await.good(),
        import_counts(0, 0, 2, 0, 0)
    );
    // One file moves a port call into the time of another, and that one away.
    let file = format!("{HEADER}{}{}", row("a", "NLRTM", 10), row("b", "BEANR", 12));
    assert_eq!(
        import(&ada, &csv, &file).await.good(),
        import_counts(0, 2, 0, 0, 0)
    );
    assert_eq!(listed(&ada, &path(&nao)).await, ["NLRTM 10", "BEANR 12"]);
    let list = ada.get(&path(&nao)).await.good();
    assert_eq!(list["items"][0]["source"], "csv");
    assert_eq!(list["items"][0]["revision"], 2);
    server.finish().await;
}

/// Imports a nightly export that still contains a past port call.
async fn a_csv_with_past_port_calls_is_imported(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    let csv = format!("{}.csv", path(&nao));
    let file = format!("{HEADER}{}{}", row("a", "NLRTM", 8), row("b", "BEANR", 20));
    assert_eq!(
        import(&ada, &csv, &file).await.good(),
        import_counts(2, 0, 0, 0, 0)
    );
    server.advance(20.0 * 86_400.0);
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    assert_eq!(
        import(&ada, &csv, &file).await.good(),
        import_counts(0, 0, 1, 0, 1)
    );
    let all = format!("{csv}?replace=true");
    assert_eq!(
        import(&ada, &all, &file).await.good(),
        import_counts(0, 0, 1, 0, 1)
    );
    assert_eq!(listed(&ada, &path(&nao)).await, ["NLRTM 08", "BEANR 20"]);
    server.finish().await;
}

async fn a_csv_of_a_european_spreadsheet_is_imported(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    let csv = format!("{}.csv", path(&nao));
    let file = "\u{feff}id;port;eta;etd;berth;eta_uncertainty_h\r\n\
                a;NLRTM;2026-12-08T06:00:00Z;2026-12-09T18:00:00Z;\"A5, south\";1,5\r\n";
    assert_eq!(
        import(&ada, &csv, file).await.good(),
        import_counts(1, 0, 0, 0, 0)
    );
    let list = ada.get(&path(&nao)).await.good();
    assert_eq!(list["items"][0]["berth"], "A5, south");
    assert_eq!(list["items"][0]["eta_uncertainty_h"], 1.5);
    for (file, message) in [
        ("id;port,eta;etd\n", "has both commas and semicolons"),
        (
            "id;port;eta;etd\na,NLRTM,x,y\n",
            "1 fields, where the first line has 4",
        ),
        (
            "id;port;eta;etd\na;NLRTM;2026-12-10T06:00:00;2026-12-11T06:00:00Z\n",
            "line 2: eta: \"2026-12-10T06:00:00\" has no time zone",
        ),
    ] {
        let refused = import(&ada, &csv, file).await;
        assert_eq!(refused.problem(), "invalid");
        let detail = refused.json()["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains(message), "{detail}");
    }
    server.finish().await;
}

async fn a_csv_with_one_invalid_line_changes_nothing(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    ada.post(&path(&nao), &call("NLRTM", 20)).await.good();
    let csv = format!("{}.csv", path(&nao));
    let good = row("a", "NLRTM", 8);
    for (rows, message) in [
        (
            format!("{good}b,BEANR,2026-12-10T06:00:00,2026-12-11T06:00:00Z,\n"),
            "file: line 3: eta: \"2026-12-10T06:00:00\" has no time zone",
        ),
        (
            format!("{good}{}", row("b", "BEANR", 9)),
            "file: line 3: eta: overlaps call \"a\" of the same vessel",
        ),
        (
            format!("{good}{}", row("b", "BEANR", 21)),
            "file: line 3: eta: overlaps call \"NLRTM 2026-12-20T06:00:00Z\"",
        ),
        (
            format!("{good}{good}"),
            "file: line 3: id: \"a\" is already on line 2",
        ),
        (
            format!("{good}{}", row(&"x".repeat(201), "BEANR", 12)),
            "file: line 3: reference: is longer than 200",
        ),
        (
            format!("{good}b,BEANR,9999-11-10T06:00:00Z,9999-11-11T06:00:00Z,\n"),
            "file: line 3: eta: 9999-11-10T06:00:00Z is more than 730 days ahead",
        ),
    ] {
        let response = import(&ada, &csv, format!("{HEADER}{rows}")).await;
        assert_eq!(response.problem(), "invalid");
        let detail = response.json()["detail"].as_str().unwrap().to_owned();
        assert!(detail.starts_with(message), "{detail}\nis not\n{message}");
    }
    assert_eq!(listed(&ada, &path(&nao)).await, ["NLRTM 20"]);
    server.finish().await;
}

async fn a_replacing_file_withdraws_missing_port_calls(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    ada.post(&path(&nao), &call("ESBIO", 4)).await.good();
    let csv = format!("{}.csv?replace=true", path(&nao));
    let file = format!("{HEADER}{}{}", row("a", "NLRTM", 8), row("b", "BEANR", 10));
    import(&ada, &csv, &file).await.good();
    let file = format!("{HEADER}{}", row("c", "DEHAM", 9));
    assert_eq!(
        import(&ada, &csv, &file).await.good(),
        import_counts(1, 0, 0, 2, 0)
    );
    // Port calls entered by hand stay.
    assert_eq!(listed(&ada, &path(&nao)).await, ["ESBIO 04", "DEHAM 09"]);
    // A returning port call is valid again, with its history.
    let file = format!("{HEADER}{}", row("a", "NLRTM", 8));
    assert_eq!(
        import(&ada, &csv, &file).await.good(),
        import_counts(0, 1, 0, 1, 0)
    );
    let list = ada.get(&path(&nao)).await.good();
    assert_eq!(list["items"][1]["revision"], 2);
    server.finish().await;
}

async fn a_csv_of_the_fleet_names_vessels_by_number_name_or_id(server: TestServer) {
    let ada = server.admin("ada").await;
    let numbered = json!({ "name": "Nao", "imo_number": "9074729" });
    let nao = ada.post("/vessels", &numbered).await.good();
    let pinta = ada.create_vessel("La Pinta").await;
    let id = pinta["id"].as_str().unwrap();
    let rows = |vessels: [&str; 2]| {
        let [first, second] = vessels;
        format!(
            "vessel,{HEADER}{first},{}{second},{}",
            row("a", "NLRTM", 8),
            row("a", "NLRTM", 8)
        )
    };
    let taken = import(&ada, "/port-calls.csv", rows(["9074729", "la pinta"])).await;
    assert_eq!(taken.good(), import_counts(2, 0, 0, 0, 0));
    assert_eq!(listed(&ada, &path(&nao)).await, ["NLRTM 08"]);
    assert_eq!(listed(&ada, &path(&pinta)).await, ["NLRTM 08"]);
    let twice = import(&ada, "/port-calls.csv", rows(["La Pinta", id])).await;
    assert!(
        twice
            .text
            .contains("line 3: id: \\\"a\\\" is already on line 2")
    );
    let nobody = import(&ada, "/port-calls.csv", rows(["Nao", "Niña"])).await;
    assert!(nobody.text.contains("line 3: vessel: there is no vessel"));
    // Every row is checked, whatever is wrong with another one.
    let more = format!(
        "{}Nao,c,NLRTM,soon,2026-12-20T00:00:00Z,\nNao,{}",
        rows(["Niña", "Santa"]),
        row("b", "BEANR", 9)
    );
    let wrong = import(&ada, "/port-calls.csv", more).await.json();
    let wrong = wrong["detail"].as_str().unwrap();
    for message in [
        "line 2: vessel",
        "line 3: vessel",
        "line 4: eta",
        "line 5: eta: overlaps",
    ] {
        assert!(wrong.contains(message), "{wrong}");
    }
    assert_eq!(listed(&ada, &path(&nao)).await, ["NLRTM 08"]);
    ada.create_vessel("Nao").await;
    let which = import(&ada, "/port-calls.csv", rows(["Nao", id])).await;
    assert!(which.text.contains("several vessels; use the IMO number"));
    server.finish().await;
}

fn calendar(events: &[String]) -> String {
    let events = events.concat();
    format!("BEGIN:VCALENDAR\r\nVERSION:2.0\r\n{events}END:VCALENDAR\r\n")
}

fn event(id: &str, port: &str, day: &str, more: &str) -> String {
    format!(
        "BEGIN:VEVENT\r\nUID:{id}\r\nDTSTART:{day}T060000Z\r\nDTEND:{day}T200000Z\r\n\
         LOCATION:{port}\r\n{more}END:VEVENT\r\n"
    )
}

async fn a_calendar_is_imported_and_its_cancellations_withdraw(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    let ics = format!("{}.ics", path(&nao));
    let first = calendar(&[
        event("a@agent", "Bilbao\\, ES BIO", "20261208", ""),
        event("b@agent", "NLRTM", "20261210", ""),
        event("old@agent", "NLRTM", "20261101", ""),
    ]);
    assert_eq!(
        import(&ada, &ics, &first).await.good(),
        import_counts(2, 0, 0, 0, 1)
    );
    let next = calendar(&[
        event("a@agent", "NLRTM", "20261208", "STATUS:CANCELLED\r\n"),
        event("b@agent", "NLRTM", "20261211", ""),
    ]);
    assert_eq!(
        import(&ada, &ics, &next).await.good(),
        import_counts(0, 1, 0, 1, 0)
    );
    assert_eq!(listed(&ada, &path(&nao)).await, ["NLRTM 11"]);
    let all = format!("{}?withdrawn=true", path(&nao));
    let all = ada.get(&all).await.good();
    let cancelled = &all["items"][0];
    assert_eq!(cancelled["withdrawal_reason"], "cancelled in the file");
    let floating = next.replace("20261211T060000Z", "20261211T060000");
    let response = import(&ada, &ics, floating).await;
    assert!(
        response.text.contains("file: line 12: DTSTART: "),
        "{response:?}"
    );
    assert!(response.text.contains("has no time zone"));
    server.finish().await;
}

async fn a_file_of_fifty_megabytes_is_refused_with_a_problem(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    let line = row("a", "NLRTM", 8);
    let file = format!("{HEADER}{}", line.repeat(50_000_000 / line.len()));
    for path in [format!("{}.csv", path(&nao)), "/port-calls.csv".to_owned()] {
        let response = import(&ada, &path, file.as_str()).await;
        assert_eq!(response.problem(), "too-large");
        assert!(response.text.contains("8388608 bytes"), "{response:?}");
    }
    assert_eq!(listed(&ada, &path(&nao)).await, [] as [&str; 0]);
    server.finish().await;
}

async fn an_exported_file_can_be_imported(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    let mut formula = call("NLRTM", 8);
    formula["reference"] = json!("=1+1");
    formula["berth_heading_deg"] = json!(112.5);
    ada.post(&path(&nao), &formula).await.good();
    let csv = format!("{}.csv", path(&nao));
    let exported = ada.get(&csv).await;
    assert!(exported.text.contains("\n'=1+1,"), "{exported:?}");
    let repeated = import(&ada, &csv, exported.text.as_str()).await.good();
    assert_eq!(repeated, import_counts(0, 0, 1, 0, 0));
    server.finish().await;
}

async fn a_file_may_name_only_ones_own_vessels(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let nao = ada.create_vessel("Nao").await;
    let file = format!("{HEADER}{}", row("a", "NLRTM", 8));
    let csv = format!("{}.csv", path(&nao));
    assert_eq!(import(&eve, &csv, &file).await.problem(), "not-found");
    assert_eq!(eve.get(&csv).await.problem(), "not-found");
    let id = nao["id"].as_str().unwrap();
    let fleet = format!("vessel,{HEADER}{id},{}", row("a", "NLRTM", 8));
    let response = import(&eve, "/port-calls.csv", &fleet).await;
    assert!(response.text.contains("there is no vessel"), "{response:?}");
    // A row may not name another vessel than the path.
    let pinta = ada.create_vessel("Pinta").await;
    let other = import(&ada, &format!("{}.csv", path(&pinta)), &fleet).await;
    assert!(other.text.contains("there is no vessel"), "{other:?}");
    server.finish().await;
}
