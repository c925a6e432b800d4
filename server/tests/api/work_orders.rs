//! Work orders: from the berth's reading to the evidence and the proof at sea.

use crate::binnacles::{binnacle, put};
use crate::on_both;
use crate::support::{Answer, Person, Ship, Shore, days_at_sea, days_in, truth};
use binnacle_magnetics::field::{FieldModel, field};
use binnacle_magnetics::model::Model;
use binnacle_magnetics::position::Position;
use binnacle_magnetics::time::Timestamp;
use binnacle_server::evidence;
use binnacle_server::work_orders::entry::sha256_hex;
use reqwest::Method;
use ring::signature::{Ed25519KeyPair, KeyPair};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

on_both!(
    an_order_goes_from_the_berth_to_a_predicted_model,
    headings_at_sea_verify_an_adjustment,
    a_heading_at_sea_that_does_not_agree_is_an_alert,
    a_request_sent_again_under_its_key_writes_one_entry,
    a_bad_reading_is_kept_and_refused_with_what_could_be_wrong,
    a_step_that_reads_otherwise_is_planned_anew,
    what_cannot_be_done_in_a_state_is_refused_and_writes_nothing,
    a_compass_has_one_order_under_way,
    a_viewer_reads_an_order_and_does_not_write,
    an_order_is_blank_to_another_operator,
    each_entry_names_the_hash_of_the_one_before,
    only_a_picture_is_a_photograph,
    evidence_that_was_tampered_with_is_found_out,
);

/// The berth where all these ships are adjusted, and when the magnetometer is read.
const BERTH: (f64, f64) = (43.35, -3.04);
const AT: &str = "2026-11-21T06:30:00Z";
const HEADING_DEG: f64 = 40.0;
/// What no heading tells: the ships' λ.
const LAMBDA: f64 = 0.9;

/// A ship with a model, a binnacle with nothing in use, and an order to adjust it.
struct Job {
    person: Person,
    ship: Ship,
    compass: String,
    order: String,
}

impl Job {
    async fn begin(shore: &Shore) -> Job {
        let person = shore.admin("ada").await;
        Job::of(shore, person).await
    }

    async fn of(shore: &Shore, person: Person) -> Job {
        let ship = shore.ship(&person, "Nao").await;
        let mut samples = days_at_sea(&truth(), "2026-11-01T00:00:00Z", 10.0);
        samples.extend(days_in(
            (10.0, -25.0),
            &truth(),
            "2026-11-11T00:00:00Z",
            5.0,
        ));
        samples.extend(days_at_sea(&truth(), "2026-11-16T00:00:00Z", 4.0));
        ship.put(1, &samples).await.good();
        shore.advance(60.0);
        shore.work().await;
        let compasses = person.get(&ship.path("/compasses")).await.good();
        let compass = compasses["items"][0]["id"].as_str().unwrap().to_owned();
        let path = ship.path(&format!("/compasses/{compass}/binnacle"));
        put(&person, &path, &binnacle()).await.good();
        let mut job = Job {
            person,
            ship,
            compass,
            order: String::new(),
        };
        let made = job.person.post("/work-orders", &job.new_order()).await;
        let made = made.good();
        made["id"].as_str().unwrap().clone_into(&mut job.order);
        job
    }

    fn new_order(&self) -> Value {
        json!({
            "vessel_id": self.ship.id, "compass_id": self.compass, "port": "Bilbao",
            "berth": "A5", "planned_at": "2026-11-21T06:00:00Z",
            "adjuster_name": "M. Etxeberria",
        })
    }

    fn path(&self, rest: &str) -> String {
        format!("/work-orders/{}{rest}", self.order)
    }

    async fn post(&self, rest: &str, body: &Value) -> Answer {
        self.person.post(&self.path(rest), body).await
    }

    async fn seen(&self) -> Value {
        self.person.get(&self.path("")).await.good()
    }

    /// Reads the berth, chooses the plan, and does its steps as foretold.
    async fn adjust(&self) -> Value {
        self.post("/berth-reading", &reading()).await.good();
        let mut order = self.post("/plan", &json!({})).await.good();
        while let Some(step) = order["next_step"].as_object() {
            let path = format!("/steps/{}", step["number"]);
            let after = json!({ "after_deg": step["expected_compass_deg"] });
            order = self.post(&path, &after).await.good();
            assert_ne!(order["last_step"]["verdict"], "unexplained", "{order}");
        }
        order
    }

    async fn complete(&self) -> Value {
        self.adjust().await;
        self.post("/complete", &word()).await.good()
    }

    /// So many days at sea by a model, sent and analysed.
    async fn sail(&mut self, shore: &Shore, ship: &Model, seq: u64, days: f64) -> Value {
        let samples = days_at_sea(ship, "2026-11-21T12:00:00Z", days);
        shore.advance(86_400.0 * days + 43_200.0);
        self.ship.put(seq, &samples).await.good();
        shore.advance(60.0);
        shore.work().await;
        // No session lasts so long.
        self.person = Person::sign_in(shore, self.person.operator, &self.person.email).await;
        self.seen().await
    }

    async fn open_alerts(&self) -> Vec<Value> {
        let found = self.person.get("/alerts?open=true").await.good();
        found["items"].as_array().unwrap().clone()
    }

    async fn evidence(&self) -> Vec<u8> {
        let request = self
            .person
            .request(Method::GET, &self.path("/evidence.zip"));
        let response = request.send().await.unwrap();
        assert_eq!(response.status(), 200);
        response.bytes().await.unwrap().to_vec()
    }
}

fn word() -> Value {
    json!({
        "adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114",
        "firm": "Nervión Compass", "signature": "M. Etxeberria",
    })
}

/// What a good magnetometer reads aboard the ship of these tests.
fn reading() -> Value {
    let position = Position::new(BERTH.0, BERTH.1).unwrap();
    let time = Timestamp::parse(AT).unwrap();
    let earth = field(FieldModel::Igrf14, position, 0.0, time).unwrap();
    let magnetic_deg = HEADING_DEG - earth.declination().degrees_east();
    let parameters = truth().parameters_over_lambda;
    let u = parameters.field_over_lambda(magnetic_deg.to_radians(), earth.for_ship());
    let [forward, starboard] = u.map(|part| LAMBDA * part / 1000.0);
    // A compass points along the field.
    let compass_deg = (-starboard).atan2(forward).to_degrees().rem_euclid(360.0);
    json!({
        "at": AT, "lat": BERTH.0, "lon": BERTH.1, "heading_true_deg": HEADING_DEG,
        "heading_from": "ashore", "forward": forward, "starboard": starboard,
        "unit": "microtesla", "magnetometer": "fluxgate", "compass_deg": compass_deg,
    })
}

async fn an_order_goes_from_the_berth_to_a_predicted_model(shore: Shore) {
    let job = Job::begin(&shore).await;
    let order = job.seen().await;
    assert_eq!(order["state"], "planned");
    assert_eq!(order["standing"], "predicted, not a certificate");
    let order = job.post("/berth-reading", &reading()).await.good();
    assert_eq!(order["state"], "measured");
    let lambda = order["berth"]["lambda"].as_f64().unwrap();
    assert!((lambda - LAMBDA).abs() < 0.03, "{lambda}");
    let offer = job.person.get(&job.path("/plan")).await.good();
    assert!(!offer["plans"].as_array().unwrap().is_empty());
    let order = job.adjust().await;
    assert_eq!(
        (&order["state"], &order["next_step"]),
        (&json!("adjusting"), &Value::Null)
    );
    assert!(order["steps_done"].as_u64().unwrap() > 0);
    let done = job.post("/complete", &word()).await.good();
    assert_eq!(done["state"], "adjusted");

    // The binnacle stands as it was set,
    let path = job
        .ship
        .path(&format!("/compasses/{}/binnacle", job.compass));
    let kept = job.person.get(&path).await.good();
    assert_eq!(kept["revision"], 2);
    assert_eq!(
        kept["binnacle"]["setting"],
        order["plan"]["plan"]["setting"]
    );
    // the logbook has the moment,
    let logbook = job
        .person
        .get(&job.ship.path("/logbook?kind=adjustment"))
        .await
        .good();
    assert_eq!(
        logbook["items"][0]["id"],
        done["completion"]["logbook_entry"]
    );
    assert_eq!(logbook["items"][0]["compass_id"], job.compass);
    // and the ship gets what is foretold, before and after the analysis.
    for _ in 0..2 {
        let sent = job.ship.downlink("").await;
        assert_eq!(sent["model"]["id"], done["completion"]["model_id"]);
        assert_eq!(sent["model"]["replaces"]["reason"], "adjustment");
        assert_eq!(sent["card_withdrawn"], Value::Null);
        shore.work().await;
    }
    let model = job.person.get(&job.ship.path("/model")).await.good();
    assert_eq!(model["foretold_by"], job.order);
    assert_eq!(job.open_alerts().await, Vec::<Value>::new());
    shore.finish().await;
}

fn foretold(order: &Value) -> Model {
    serde_json::from_value(order["completion"]["model"].clone()).unwrap()
}

async fn headings_at_sea_verify_an_adjustment(shore: Shore) {
    let mut job = Job::begin(&shore).await;
    let done = job.complete().await;
    assert_eq!(done["verification"], Value::Null);
    let ship = foretold(&done);
    let some = job.sail(&shore, &ship, 2, 0.25).await;
    assert_eq!(some["state"], "adjusted");
    assert_eq!(
        some["verification"]["verification"]["verdict"],
        "more_needed"
    );
    let needed = &some["verification"]["verification"]["needed"]["count"];
    assert!(needed.as_u64().unwrap() > 0, "{some}");
    let early = job.post("/close", &json!({ "text": "done" })).await;
    assert_eq!(early.problem(), "wrong-state");
    let more = job.sail(&shore, &ship, 3, 6.0).await;
    assert_eq!(more["state"], "verified", "{}", more["verification"]);
    assert_eq!(more["standing"], "verified at sea");
    assert_eq!(job.open_alerts().await, Vec::<Value>::new());
    let closed = job.post("/close", &json!({ "text": "done" })).await.good();
    assert_eq!(
        (&closed["state"], &closed["standing"]),
        (&json!("closed"), &json!("verified at sea"))
    );
    shore.finish().await;
}

async fn a_heading_at_sea_that_does_not_agree_is_an_alert(shore: Shore) {
    let mut job = Job::begin(&shore).await;
    let mut ship = foretold(&job.complete().await);
    ship.parameters_over_lambda.bx_nt += 4000.0;
    let failed = job.sail(&shore, &ship, 2, 1.0).await;
    assert_eq!(failed["state"], "failed");
    assert_eq!(failed["standing"], "predicted, not a certificate");
    let alerts = job.open_alerts().await;
    let ours = alerts
        .iter()
        .find(|alert| alert["cause"] == "adjustment_not_confirmed");
    let ours = ours.unwrap_or_else(|| panic!("{alerts:?}"));
    assert_eq!(ours["severity"], "critical");
    shore.finish().await;
}

async fn a_request_sent_again_under_its_key_writes_one_entry(shore: Shore) {
    let job = Job::begin(&shore).await;
    let send = |rest: &str, body: Value, key: &str| {
        let request = job.person.request(Method::POST, &job.path(rest));
        Answer::of(request.header("idempotency-key", key).json(&body))
    };
    let mut bad = reading();
    bad["unit"] = json!("nanotesla");
    let steps: [(&str, Value, u16); 4] = [
        ("/remarks", json!({ "text": "crane alongside" }), 200),
        ("/berth-reading", bad, 422),
        ("/berth-reading", reading(), 200),
        ("/plan", json!({ "plan": 1 }), 200),
    ];
    for (index, (rest, body, status)) in steps.into_iter().enumerate() {
        let key = format!("key {index}");
        let first = send(rest, body.clone(), &key).await;
        assert_eq!(first.status, status, "{first:?}");
        let seq = job.seen().await["last_seq"].clone();
        let again = send(rest, body, &key).await;
        assert_eq!((again.status, &again.text), (first.status, &first.text));
        assert_eq!(job.seen().await["last_seq"], seq, "{rest}");
    }
    // A step that was sent again is not the next one.
    let step = job.seen().await["next_step"].clone();
    let path = format!("/steps/{}", step["number"]);
    let read = json!({ "after_deg": step["expected_compass_deg"] });
    let first = send(&path, read.clone(), "step").await.good();
    let again = send(&path, read, "step").await.good();
    assert_eq!(first["steps_done"], 1);
    assert_eq!(first, again);
    let other = send(&path, json!({ "after_deg": 1.0 }), "step").await;
    assert_eq!(other.problem(), "idempotency-key-reused");
    let request = job.person.request(Method::POST, "/work-orders");
    let reused = request
        .header("idempotency-key", "step")
        .json(&job.new_order());
    assert_eq!(Answer::of(reused).await.problem(), "idempotency-key-reused");
    shore.finish().await;
}

async fn a_bad_reading_is_kept_and_refused_with_what_could_be_wrong(shore: Shore) {
    let job = Job::begin(&shore).await;
    let good = reading();
    let part = |name: &str| good[name].as_f64().unwrap();
    let with = |changes: Value| {
        let mut body = good.clone();
        for (name, value) in changes.as_object().unwrap() {
            body[name] = value.clone();
        }
        body
    };
    let (forward, starboard) = (part("forward"), part("starboard"));
    for (entries, (body, said)) in [
        (
            with(json!({ "forward": forward / 100.0, "starboard": starboard / 100.0 })),
            "the figures are in gauss, not in microtesla",
        ),
        (
            with(json!({ "forward": starboard, "starboard": forward })),
            "axes are swapped",
        ),
        (
            with(json!({ "heading_true_deg": HEADING_DEG + 180.0 })),
            "180 degrees off",
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let answer = job.post("/berth-reading", &body).await;
        assert_eq!(
            (answer.status, answer.problem().as_str()),
            (422, "not-adjustable")
        );
        let refusal = answer.json()["refusals"][0].clone();
        let could_be = refusal["could_be"].to_string();
        assert!(could_be.contains(said), "{said}: {refusal}");
        assert!(!refusal["cures"].as_array().unwrap().is_empty());
        let order = job.seen().await;
        assert_eq!(
            (&order["state"], &order["reading"]),
            (&json!("planned"), &Value::Null)
        );
        assert_eq!(order["last_seq"], 2 + entries, "it is kept");
    }
    for (body, named) in [
        (with(json!({ "unit": "furlong" })), "unit"),
        (with(json!({ "forward": "much" })), "forward"),
        (with(json!({ "lat": 91.0 })), "lat"),
        (with(json!({ "at": "2027-01-01T00:00:00Z" })), "at"),
        (with(json!({ "foreward": 1.0 })), "foreward"),
    ] {
        let answer = job.post("/berth-reading", &body).await;
        assert_eq!((answer.status, answer.problem().as_str()), (422, "invalid"));
        assert!(answer.text.contains(named), "{named}: {answer:?}");
    }
    assert_eq!(
        job.seen().await["last_seq"],
        4,
        "what cannot be read is not kept"
    );
    shore.finish().await;
}

async fn a_step_that_reads_otherwise_is_planned_anew(shore: Shore) {
    let job = Job::begin(&shore).await;
    job.post("/berth-reading", &reading()).await.good();
    let mut order = job.post("/plan", &json!({})).await.good();
    // The first step with magnets in it, which a heading between the cardinals shows.
    while order["next_step"]["to"]["place"] != "magnets" {
        let step = &order["next_step"];
        let path = format!("/steps/{}", step["number"]);
        let after = json!({ "after_deg": step["expected_compass_deg"] });
        order = job.post(&path, &after).await.good();
    }
    let step = order["next_step"].clone();
    let before = order["compass_deg"].as_f64().unwrap();
    let change = step["change_deg"].as_f64().unwrap();
    let path = format!("/steps/{}", step["number"]);
    let wild = json!({ "after_deg": (before + 90.0).rem_euclid(360.0) });
    let unexplained = job.post(&path, &wild).await.good();
    assert_eq!(unexplained["last_step"]["verdict"], "unexplained");
    assert_eq!(
        unexplained["next_step"]["number"], step["number"],
        "it is to be read again"
    );
    let stronger = json!({ "after_deg": (before + 1.8 * change).rem_euclid(360.0) });
    let replanned = job.post(&path, &stronger).await.good();
    assert_eq!(
        replanned["last_step"]["verdict"], "other_strength",
        "{}",
        replanned["last_step"]
    );
    assert_eq!(replanned["steps_done"], 0);
    assert_eq!(
        replanned["setting"], step["setting_after"],
        "it stands as it was set"
    );
    shore.finish().await;
}

async fn what_cannot_be_done_in_a_state_is_refused_and_writes_nothing(shore: Shore) {
    let job = Job::begin(&shore).await;
    let refused = |answer: Answer| {
        assert_eq!(
            (answer.status, answer.problem().as_str()),
            (409, "wrong-state")
        );
    };
    refused(job.post("/plan", &json!({})).await);
    refused(job.person.get(&job.path("/plan")).await);
    refused(job.post("/steps/1", &json!({ "after_deg": 1.0 })).await);
    refused(
        job.post("/corrector-settings", &json!({ "setting": {} }))
            .await,
    );
    refused(job.post("/complete", &word()).await);
    refused(job.person.get(&job.path("/evidence.zip")).await);
    let key = json!({ "public_key": "00".repeat(32), "signature": "00".repeat(64) });
    refused(job.post("/signatures", &key).await);
    assert_eq!(job.seen().await["last_seq"], 1);
    job.post("/berth-reading", &reading()).await.good();
    job.post("/plan", &json!({})).await.good();
    refused(job.post("/steps/99", &json!({ "after_deg": 1.0 })).await);
    refused(job.post("/complete", &word()).await);
    let tray = json!([{ "hole": 99, "magnet": "200 mm", "count": 1, "red": "port" }]);
    let nowhere = json!({ "setting": { "athwartship": tray } });
    let answer = job.post("/corrector-settings", &nowhere).await;
    assert_eq!((answer.status, answer.problem().as_str()), (422, "invalid"));
    assert!(answer.text.contains("athwartship[0].hole"), "{answer:?}");
    let none = job.post("/plan", &json!({ "plan": 99 })).await;
    assert_eq!(none.problem(), "invalid");
    assert_eq!(job.seen().await["last_seq"], 3);
    let cancelled = job
        .post("/cancel", &json!({ "text": "she sails" }))
        .await
        .good();
    assert_eq!(cancelled["state"], "cancelled");
    refused(job.post("/berth-reading", &reading()).await);
    refused(job.post("/cancel", &json!({ "text": "again" })).await);
    shore.finish().await;
}

async fn a_compass_has_one_order_under_way(shore: Shore) {
    let job = Job::begin(&shore).await;
    let second = job.person.post("/work-orders", &job.new_order()).await;
    assert_eq!(
        (second.status, second.problem().as_str()),
        (409, "wrong-state")
    );
    job.post("/cancel", &json!({ "text": "another day" }))
        .await
        .good();
    let third = job
        .person
        .post("/work-orders", &job.new_order())
        .await
        .good();
    let list = job.person.get("/work-orders?limit=1").await.good();
    assert_eq!(list["items"][0]["id"], third["id"]);
    let next = list["next"].as_str().unwrap();
    let list = job
        .person
        .get(&format!("/work-orders?after={next}"))
        .await
        .good();
    assert_eq!(list["items"][0]["id"], job.order);
    let list = job.person.get("/work-orders?state=planned").await.good();
    assert_eq!(list["items"].as_array().unwrap().len(), 1);
    shore.finish().await;
}

async fn a_viewer_reads_an_order_and_does_not_write(shore: Shore) {
    let job = Job::begin(&shore).await;
    let bob = job.person.viewer(&shore).await;
    assert_eq!(bob.get(&job.path("")).await.good()["state"], "planned");
    assert_eq!(
        bob.get(&job.path("/entries")).await.good()["items"][0]["seq"],
        1
    );
    for (rest, body) in [
        ("/berth-reading", reading()),
        ("/plan", json!({})),
        ("/steps/1", json!({ "after_deg": 1.0 })),
        ("/corrector-settings", json!({ "setting": {} })),
        ("/remarks", json!({ "text": "hm" })),
        ("/cancel", json!({ "text": "hm" })),
        ("/close", json!({ "text": "hm" })),
        ("/complete", word()),
    ] {
        let answer = bob.post(&job.path(rest), &body).await;
        assert_eq!(
            (answer.status, answer.problem().as_str()),
            (403, "forbidden"),
            "{rest}"
        );
    }
    let made = bob.post("/work-orders", &job.new_order()).await;
    assert_eq!(made.problem(), "forbidden");
    assert_eq!(job.seen().await["last_seq"], 1);
    shore.finish().await;
}

async fn an_order_is_blank_to_another_operator(shore: Shore) {
    let job = Job::begin(&shore).await;
    let eve = shore.admin("eve").await;
    for rest in ["", "/entries", "/plan", "/evidence.zip", "/record.json"] {
        assert_eq!(
            eve.get(&job.path(rest)).await.problem(),
            "not-found",
            "{rest}"
        );
    }
    let key = json!({ "public_key": "00".repeat(32), "signature": "00".repeat(64) });
    for (rest, body) in [
        ("/berth-reading", reading()),
        ("/plan", json!({})),
        ("/steps/1", json!({ "after_deg": 1.0 })),
        ("/corrector-settings", json!({ "setting": {} })),
        ("/remarks", json!({ "text": "hm" })),
        ("/cancel", json!({ "text": "hm" })),
        ("/close", json!({ "text": "hm" })),
        ("/complete", word()),
        ("/signatures", key),
    ] {
        let answer = eve.post(&job.path(rest), &body).await;
        assert_eq!(answer.problem(), "not-found", "{rest}");
    }
    let made = eve.post("/work-orders", &job.new_order()).await;
    assert_eq!(made.problem(), "not-found");
    assert_eq!(eve.get("/work-orders").await.good()["items"], json!([]));
    shore.finish().await;
}

async fn each_entry_names_the_hash_of_the_one_before(shore: Shore) {
    let job = Job::begin(&shore).await;
    job.complete().await;
    let log = job.person.get(&job.path("/entries")).await.good();
    let entries = log["items"].as_array().unwrap();
    assert!(entries.len() > 4, "{}", entries.len());
    let mut previous = Value::Null;
    for (index, found) in entries.iter().enumerate() {
        assert_eq!(found["seq"], index + 1);
        assert_eq!(found["entry"]["previous_sha256"], previous);
        previous = found["sha256"].clone();
    }
    assert_eq!(job.seen().await["last_sha256"], previous);
    shore.finish().await;
}

const PICTURE: &[u8] = &[0xFF, 0xD8, 0xFF, 0xE0, 0, 16, b'J', b'F', b'I', b'F'];

impl Job {
    async fn photo(&self, bytes: &'static [u8]) -> Answer {
        let path = self.path("/photos?caption=trays");
        Answer::of(self.person.request(Method::POST, &path).body(bytes)).await
    }
}

async fn only_a_picture_is_a_photograph(shore: Shore) {
    let job = Job::begin(&shore).await;
    let page = job.photo(b"<html><script>alert(1)</script>").await;
    assert_eq!(
        (page.status, page.problem().as_str()),
        (415, "unsupported-media-type")
    );
    job.photo(PICTURE).await.good();
    let order = job.seen().await;
    assert_eq!(order["photos"].as_array().unwrap().len(), 1);
    let log = job.person.get(&job.path("/entries?after=1")).await.good();
    let taken = &log["items"][0]["entry"]["content"];
    assert_eq!(
        (&taken["media_type"], &taken["caption"]),
        (&json!("image/jpeg"), &json!("trays"))
    );
    let path = job.path(&format!("/photos/{}", taken["photo"].as_str().unwrap()));
    let request = job.person.request(Method::GET, &path).send().await.unwrap();
    assert_eq!(request.headers()["content-type"], "image/jpeg");
    assert_eq!(request.headers()["content-disposition"], "attachment");
    assert_eq!(request.headers()["x-content-type-options"], "nosniff");
    assert_eq!(request.bytes().await.unwrap(), PICTURE);
    let large = Box::leak(vec![0xFF_u8; 11 * 1024 * 1024].into_boxed_slice());
    assert_eq!(job.photo(large).await.status, 413);
    shore.finish().await;
}

fn unpacked(bytes: &[u8]) -> BTreeMap<String, Vec<u8>> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
    (0..archive.len())
        .map(|index| {
            let mut file = archive.by_index(index).unwrap();
            let name = file.name().unwrap().into_owned();
            let mut content = Vec::new();
            file.read_to_end(&mut content).unwrap();
            (name, content)
        })
        .collect()
}

fn packed(files: &BTreeMap<String, Vec<u8>>) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, content) in files {
        writer.start_file(name.as_str(), stored).unwrap();
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn hex(bytes: &[u8]) -> String {
    let digits = |text: String, byte: &u8| text + &format!("{byte:02x}");
    bytes.iter().fold(String::new(), digits)
}

/// Puts the manifest right about a file that was changed, as a forger would.
fn forge(files: &mut BTreeMap<String, Vec<u8>>, name: &str, content: Vec<u8>) {
    let mut manifest: Value = serde_json::from_slice(&files["manifest.json"]).unwrap();
    manifest["files"][name] = json!(sha256_hex(&content));
    files.insert(name.to_owned(), content);
    files.insert(
        "manifest.json".to_owned(),
        manifest.to_string().into_bytes(),
    );
}

async fn evidence_that_was_tampered_with_is_found_out(shore: Shore) {
    let job = Job::begin(&shore).await;
    job.photo(PICTURE).await.good();
    let done = job.complete().await;
    let record_sha256 = done["completion"]["record_sha256"].as_str().unwrap();
    let key = Ed25519KeyPair::from_seed_unchecked(&[7; 32]).unwrap();
    let over = ring::digest::digest(
        &ring::digest::SHA256,
        job.person
            .get(&job.path("/record.json"))
            .await
            .text
            .as_bytes(),
    );
    assert_eq!(hex(over.as_ref()), record_sha256);
    let signature = hex(key.sign(over.as_ref()).as_ref());
    let public_key = hex(key.public_key().as_ref());
    let mut wrong = signature.clone();
    wrong.replace_range(0..2, if &signature[..2] == "00" { "01" } else { "00" });
    let signed = |signature: &str| json!({ "public_key": public_key, "signature": signature });
    assert_eq!(
        job.post("/signatures", &signed(&wrong)).await.problem(),
        "invalid"
    );
    job.post("/signatures", &signed(&signature)).await.good();

    let whole = job.evidence().await;
    assert_eq!(
        whole,
        job.evidence().await,
        "the same state makes the same octets"
    );
    let found = evidence::verify(&whole);
    assert_eq!(found.problems, Vec::<String>::new());
    assert!(
        found.facts.iter().any(|fact| fact.contains(&public_key)),
        "{found:?}"
    );
    let files = unpacked(&whole);
    assert!(String::from_utf8_lossy(&files["README.txt"]).contains("not a certificate"));
    assert!(
        String::from_utf8_lossy(&files["record.json"]).contains("predicted, not a certificate")
    );
    assert!(
        files.keys().any(|name| name.starts_with("photos/")),
        "{:?}",
        files.keys()
    );
    for name in files.keys() {
        let mut without = files.clone();
        without.remove(name);
        assert!(
            !evidence::verify(&packed(&without)).problems.is_empty(),
            "without {name}"
        );
        let mut changed = files.clone();
        let content = changed.get_mut(name).unwrap();
        // A digit for another, so that JSON stays JSON; a picture has none.
        let place = content.iter().rposition(u8::is_ascii_digit);
        let byte = &mut content[place.unwrap_or(0)];
        *byte = if *byte == b'7' { b'8' } else { b'7' };
        let problems = evidence::verify(&packed(&changed)).problems;
        assert!(!problems.is_empty(), "{name} changed");
    }

    // Whoever puts the manifest right as well is caught by the log,
    for name in files
        .keys()
        .filter(|name| name.starts_with("photos/") || *name == "record.json")
    {
        let mut forged = files.clone();
        let mut content = files[name].clone();
        content.push(b' ');
        forge(&mut forged, name, content);
        let problems = evidence::verify(&packed(&forged)).problems;
        assert_eq!(problems.len(), 1, "{name}: {problems:?}");
    }
    // a log that lost a line by its chain, and one that lost its end by its head.
    let log = String::from_utf8(files["entries.ndjson"].clone()).unwrap();
    let lines: Vec<&str> = log.lines().collect();
    for left_out in 0..lines.len() {
        let mut kept = lines.clone();
        kept.remove(left_out);
        let mut forged = files.clone();
        forge(&mut forged, "entries.ndjson", kept.join("\n").into_bytes());
        let problems = evidence::verify(&packed(&forged)).problems;
        assert!(!problems.is_empty(), "without line {}", left_out + 1);
    }
    assert!(!evidence::verify(b"not an archive").problems.is_empty());
    shore.finish().await;
}
