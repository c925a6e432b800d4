//! Calendar feeds of work orders, port calls and due dates.

use crate::schedule::{compass_of, due_vessel, enter_port_call};
use binnacle_planning::notifications::notify_of_needs;
use binnacle_server_testing::offers::OfferParties;
use binnacle_server_testing::on_both;
use binnacle_server_testing::patch;
use binnacle_server_testing::port_calls;
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use icalendar::{CalendarComponent, CalendarDateTime, Component, DatePerhapsTime};
use reqwest::Method;
use serde_json::{Value, json};
use std::collections::BTreeMap;

on_both!(
    a_calendar_is_readable_by_its_secret_address_until_removed,
    an_event_keeps_its_uid_and_its_sequence_grows,
    a_firms_calendar_shows_what_the_firm_sees,
    a_vessels_calendar_shows_that_vessel,
    long_and_unusual_text_is_unchanged,
    a_vessels_calendar_follows_its_port_calls_and_due_dates,
    a_fleet_calendar_covers_all_vessels_and_a_firms_only_its_orders,
);

/// Returns the unfolded lines of a calendar, after checking their form.
fn lines(text: &str) -> Vec<String> {
    assert!(text.ends_with("END:VCALENDAR\r\n"), "{text:?}");
    let mut unfolded: Vec<String> = Vec::new();
    for line in text.strip_suffix("\r\n").unwrap().split("\r\n") {
        assert!(line.len() <= 75, "{line:?}");
        assert!(!line.contains(['\r', '\n']), "{line:?}");
        match line.strip_prefix(' ') {
            Some(rest) => unfolded.last_mut().unwrap().push_str(rest),
            None => unfolded.push(line.to_owned()),
        }
    }
    assert_eq!(unfolded[..2], ["BEGIN:VCALENDAR", "VERSION:2.0"]);
    let begun = |word: &str| {
        unfolded
            .iter()
            .filter(|line| line.starts_with(word))
            .count()
    };
    let events = begun("BEGIN:VEVENT");
    for needed in ["UID:", "DTSTAMP:"] {
        assert_eq!(begun(needed), events + begun("BEGIN:VALARM"), "{needed}");
    }
    for needed in ["END:VEVENT", "DTSTART:", "SEQUENCE:", "STATUS:"] {
        assert_eq!(begun(needed), events, "{needed}");
    }
    unfolded
}

/// Returns a property of a calendar's only event.
fn property(lines: &[String], key: &str) -> String {
    let of_event = lines.iter().take_while(|line| *line != "BEGIN:VALARM");
    let prefix = format!("{key}:");
    let mut found = of_event.filter_map(|line| line.strip_prefix(&prefix));
    let value = found
        .next()
        .unwrap_or_else(|| panic!("no {key} in {lines:?}"));
    assert_eq!(found.next(), None, "{key} stands there twice");
    value.to_owned()
}

async fn create_feed(person: &Person, new: &Value) -> Value {
    let made = person.post("/calendar-feeds", new).await;
    assert_eq!(made.status, 201, "{made:?}");
    made.good()
}

/// Reads a calendar by its address alone.
async fn read_feed(server: &TestServer, made: &Value) -> ApiResponse {
    let url = made["url"].as_str().unwrap();
    let path = url.strip_prefix("https://binnacle.example").unwrap();
    ApiResponse::send(server.http.get(format!("{}{path}", server.url))).await
}

async fn a_calendar_is_readable_by_its_secret_address_until_removed(server: TestServer) {
    let parties = OfferParties::planned(&server, 0).await;
    let made = create_feed(&parties.ada, &json!({ "name": "Our fleet" })).await;
    let found = read_feed(&server, &made).await;
    assert_eq!(
        found.headers["content-type"],
        "text/calendar; charset=utf-8"
    );
    let calendar = lines(&found.text);
    assert_eq!(property(&calendar, "X-WR-CALNAME"), "Our fleet");
    assert_eq!(property(&calendar, "DTSTART"), "20261122T080000Z");
    assert_eq!(property(&calendar, "DTEND"), "20261122T110000Z");
    assert_eq!(property(&calendar, "STATUS"), "TENTATIVE");
    assert_eq!(property(&calendar, "LOCATION"), "Bilbao\\, A5");
    assert_eq!(found.text, read_feed(&server, &made).await.text);
    // A token or a session reads the same; without them nothing.
    let own = parties.ada.get("/calendar.ics").await;
    assert_eq!(
        property(&lines(&own.text), "UID"),
        property(&calendar, "UID")
    );
    let url = format!("{}/api/v1/calendar.ics?token=bnc_wrong", server.url);
    let wrong = ApiResponse::send(server.http.get(url)).await;
    assert_eq!(wrong.problem(), "unauthenticated");

    let listed = parties.ada.get("/calendar-feeds").await.good();
    assert!(!listed.to_string().contains("bnc_"), "{listed}");
    let path = format!("/calendar-feeds/{}", made["id"].as_str().unwrap());
    let eve = server.admin("eve").await;
    assert_eq!(eve.get("/calendar-feeds").await.good()["items"], json!([]));
    let theirs = ApiResponse::send(eve.request(Method::DELETE, &path)).await;
    assert_eq!(theirs.problem(), "not-found");
    let removed = ApiResponse::send(parties.ada.request(Method::DELETE, &path)).await;
    assert_eq!(removed.status, 204);
    assert_eq!(read_feed(&server, &made).await.problem(), "unauthenticated");
    server.finish().await;
}

async fn an_event_keeps_its_uid_and_its_sequence_grows(server: TestServer) {
    let parties = OfferParties::planned(&server, 1).await;
    let made = create_feed(&parties.ada, &json!({ "name": "Our fleet" })).await;
    let before = lines(&read_feed(&server, &made).await.text);
    server.advance(60.0);
    parties
        .post(&parties.ada, "/offer", &parties.offer())
        .await
        .good();
    parties
        .post(&parties.firms[0].1, "/accept", &json!({}))
        .await
        .good();
    let after = lines(&read_feed(&server, &made).await.text);
    assert_eq!(property(&before, "UID"), property(&after, "UID"));
    let sequence = |lines: &[String]| property(lines, "SEQUENCE").parse::<u32>().unwrap();
    assert!(sequence(&after) > sequence(&before));
    assert!(property(&after, "DTSTAMP") > property(&before, "DTSTAMP"));
    assert_eq!(property(&after, "STATUS"), "CONFIRMED");
    // Of an agreed job both are reminded a day before.
    let alarms = |lines: &[String]| {
        let alarms = lines.iter().filter(|line| *line == "BEGIN:VALARM");
        alarms.count()
    };
    assert_eq!((alarms(&before), alarms(&after)), (0, 1));
    let is_a_day_before =
        |line: &String| line.starts_with("TRIGGER") && line.ends_with(":-PT86400S");
    assert!(after.iter().any(is_a_day_before), "{after:?}");
    parties
        .post(&parties.ada, "/cancel", &json!({ "text": "sold" }))
        .await
        .good();
    let cancelled = lines(&read_feed(&server, &made).await.text);
    assert_eq!(property(&cancelled, "STATUS"), "CANCELLED");
    assert_eq!(alarms(&cancelled), 0);
    server.finish().await;
}

async fn a_firms_calendar_shows_what_the_firm_sees(server: TestServer) {
    let parties = OfferParties::offered(&server, 2).await;
    let mut feeds = Vec::new();
    for (_, adjuster) in &parties.firms {
        feeds.push(create_feed(adjuster, &json!({ "name": "Orders" })).await);
    }
    let rosas = read_feed(&server, &feeds[0]).await.text;
    assert!(
        property(&lines(&rosas), "SUMMARY").ends_with("(offered)"),
        "{rosas}"
    );
    assert!(!read_feed(&server, &feeds[1]).await.text.contains("VEVENT"));
    parties
        .post(&parties.firms[0].1, "/decline", &json!({}))
        .await;
    assert!(!read_feed(&server, &feeds[0]).await.text.contains("VEVENT"));
    assert!(read_feed(&server, &feeds[1]).await.text.contains("VEVENT"));
    server.finish().await;
}

async fn a_vessels_calendar_shows_that_vessel(server: TestServer) {
    let parties = OfferParties::planned(&server, 1).await;
    let other = parties.ada.create_vessel("Other").await;
    let new = |vessel: &Value| json!({ "name": "One ship", "vessel_id": vessel });
    let ours = create_feed(&parties.ada, &new(&parties.new_order()["vessel_id"])).await;
    let empty = create_feed(&parties.ada, &new(&other["id"])).await;
    assert!(read_feed(&server, &ours).await.text.contains("VEVENT"));
    assert!(!read_feed(&server, &empty).await.text.contains("VEVENT"));
    let eve = server.admin("eve").await;
    for who in [&eve, &parties.firms[0].1] {
        let refused = who.post("/calendar-feeds", &new(&other["id"])).await;
        assert_eq!(refused.problem(), "not-found");
    }
    server.finish().await;
}

async fn long_and_unusual_text_is_unchanged(server: TestServer) {
    let parties = OfferParties::planned(&server, 0).await;
    parties
        .post(&parties.ada, "/cancel", &json!({ "text": "x" }))
        .await
        .good();
    let mut new = parties.new_order();
    let port = "Ría de Bilbao; muelle «A», ".repeat(7);
    new["port"] = json!(port.trim());
    new["planned_at"] = json!("2026-11-23T08:00:00Z");
    parties.ada.post("/work-orders", &new).await.good();
    let calendar = lines(&parties.ada.get("/calendar.ics").await.text);
    let escaped = port.trim().replace(';', "\\;").replace(',', "\\,");
    let place = format!("LOCATION:{escaped}\\, A5");
    assert!(calendar.contains(&place), "{calendar:?}");
    server.finish().await;
}

/// Parses a calendar with another library; returns its events by UID.
pub(crate) fn events(text: &str) -> BTreeMap<String, icalendar::Event> {
    let calendar: icalendar::Calendar = text.parse().unwrap();
    let all = calendar.components.into_iter().map(|component| {
        let CalendarComponent::Event(event) = component else {
            panic!("{component:?} is no event")
        };
        (event.get_uid().unwrap().to_owned(), event)
    });
    all.collect()
}

fn instant(time: Option<DatePerhapsTime>) -> String {
    match time {
        Some(DatePerhapsTime::DateTime(CalendarDateTime::Utc(time))) => time.to_rfc3339(),
        Some(DatePerhapsTime::Date(day)) => day.to_string(),
        other => panic!("{other:?} is no time in UTC, and no day"),
    }
}

fn sequence(event: &icalendar::Event) -> u32 {
    event.property_value("SEQUENCE").unwrap().parse().unwrap()
}

async fn a_vessels_calendar_follows_its_port_calls_and_due_dates(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let call = enter_port_call(&ada, &nao, "NLRTM", 8).await;
    notify_of_needs(&server.app).await.unwrap();
    let made = create_feed(&ada, &json!({ "name": "Nao", "vessel_id": nao["id"] })).await;
    let before = events(&read_feed(&server, &made).await.text);
    let call_uid = format!("call-{}@binnacle", call["id"].as_str().unwrap());
    let due_uid = format!("due-{}@binnacle", compass_of(&nao));
    assert_eq!(before.keys().collect::<Vec<_>>(), [&call_uid, &due_uid]);
    let (was, due) = (&before[&call_uid], &before[&due_uid]);
    assert_eq!(was.get_summary(), Some("Nao at Rotterdam (NLRTM)"));
    assert_eq!(instant(was.get_start()), "2026-12-08T06:00:00+00:00");
    assert_eq!(instant(was.get_end()), "2026-12-09T18:00:00+00:00");
    assert_eq!(instant(due.get_start()), "2026-12-20");
    assert_eq!(due.get_end(), None, "a day without an end is one day");
    let why = due.get_description().unwrap();
    assert!(why.contains("24 months after the adjustment"), "{why}");
    assert_eq!(due.property_value("TRANSP"), Some("TRANSPARENT"));

    // The vessel is late with an uncertain ETA, and was adjusted meanwhile.
    server.advance(3600.0);
    let one = call["id"].as_str().unwrap();
    let one = format!("{}/{one}", port_calls::path(&nao));
    let later = json!({ "eta": "2026-12-08T12:00:00Z", "eta_uncertainty_h": 12 });
    patch(&ada, &one, &later).await.good();
    let path = format!("/vessels/{}/logbook", nao["id"].as_str().unwrap());
    let adjusted = json!({ "kind": "adjustment", "from": "2026-11-20T08:00:00Z" });
    ada.post(&path, &adjusted).await.good();
    notify_of_needs(&server.app).await.unwrap();
    let after = events(&read_feed(&server, &made).await.text);
    let (is, due_now) = (&after[&call_uid], &after[&due_uid]);
    assert_eq!(instant(is.get_start()), "2026-12-08T12:00:00+00:00");
    let description = is.get_description().unwrap();
    assert!(
        description.contains("ETA: 2026-12-08 12:00 UTC, ±12 h"),
        "{description}"
    );
    assert_eq!(instant(due_now.get_start()), "2028-11-20");
    for (before, after) in [(was, is), (due, due_now)] {
        assert!(sequence(after) > sequence(before));
        assert!(after.get_last_modified() > before.get_last_modified());
    }
    // Nothing has changed: the same bytes at the next request.
    notify_of_needs(&server.app).await.unwrap();
    let repeated = read_feed(&server, &made).await.text;
    assert_eq!(repeated, read_feed(&server, &made).await.text);
    assert_eq!(sequence(&events(&repeated)[&due_uid]), sequence(due_now));

    let why = json!({ "reason": "ice" });
    ada.post(&format!("{one}/withdraw"), &why).await.good();
    let gone = events(&read_feed(&server, &made).await.text);
    let gone = &gone[&call_uid];
    assert_eq!(gone.property_value("STATUS"), Some("CANCELLED"));
    assert!(gone.get_description().unwrap().contains("Withdrawn: ice"));
    assert!(sequence(gone) > sequence(is));
    server.finish().await;
}

async fn a_fleet_calendar_covers_all_vessels_and_a_firms_only_its_orders(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    let pinta = due_vessel(&parties.ada, "Pinta").await;
    enter_port_call(&parties.ada, &pinta, "BEANR", 8).await;
    let eve = server.admin("eve").await;
    let hers = due_vessel(&eve, "Nina").await;
    enter_port_call(&eve, &hers, "NLRTM", 8).await;
    notify_of_needs(&server.app).await.unwrap();
    let fleet = events(&parties.ada.get("/calendar.ics").await.text);
    let kinds = |begin: &str| fleet.keys().filter(|uid| uid.starts_with(begin)).count();
    assert_eq!(kinds("call-"), 1);
    // No adjustment of the other vessel is on record, so nothing is known to be due.
    assert_eq!(kinds("due-"), 1);
    assert_eq!(fleet.len(), 3);
    let firms = events(&parties.firms[0].1.get("/calendar.ics").await.text);
    assert_eq!(firms.len(), 1, "{:?}", firms.keys());
    server.finish().await;
}
