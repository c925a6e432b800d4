//! A work order: berth reading, plan, steps, completion, evidence.

use crate::binnacles::{binnacle, put};
use crate::person::{ApiResponse, Person};
use crate::server::TestServer;
use crate::ship::{Ship, days_at_sea, days_in_waters, position, true_model};
use binnacle_adjustment::binnacle::{Binnacle, Setting};
use binnacle_adjustment::corrector::effect;
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::model::Model;
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use reqwest::Method;
use serde_json::{Value, json};

/// Position of the berth: degrees north and east.
pub const BERTH: (f64, f64) = (43.35, -3.04);
/// Time of the magnetometer reading at the berth.
pub const AT: &str = "2026-11-21T06:30:00Z";
/// True heading at the berth.
pub const HEADING_DEG: f64 = 40.0;
/// The ships' λ, which no heading shows.
pub const LAMBDA: f64 = 0.9;

/// Frame header of a JPEG of 800 by 600, and the start of its scan.
pub const PICTURE: &[u8] = &[
    0xFF, 0xD8, 0xFF, 0xE0, 0, 4, 0, 0, 0xFF, 0xC0, 0, 11, 8, 0x02, 0x58, 0x03, 0x20, 1, 1, 0x11,
    0, 0xFF, 0xDA, 0, 8,
];

/// A ship with a model, a binnacle with no corrector in use, and an order to adjust it.
pub struct Job {
    /// The operator's admin, who does the work too.
    pub person: Person,
    /// The ship.
    pub ship: Ship,
    /// Id of the compass.
    pub compass: String,
    /// Id of the order.
    pub order: String,
}

impl Job {
    /// Creates the order with a new operator.
    pub async fn begin(server: &TestServer) -> Job {
        let person = server.admin("ada").await;
        Job::for_person(server, person).await
    }

    /// Creates the order for a person's operator.
    pub async fn for_person(server: &TestServer, person: Person) -> Job {
        Job::on_ship(server, person, &true_model()).await
    }

    /// Creates the order for a ship with this magnetism.
    pub async fn on_ship(server: &TestServer, person: Person, true_model: &Model) -> Job {
        let mut samples = days_at_sea(true_model, "2026-11-01T00:00:00Z", 10.0);
        samples.extend(days_in_waters(
            position(10.0, -25.0),
            true_model,
            "2026-11-11T00:00:00Z",
            5.0,
        ));
        samples.extend(days_at_sea(true_model, "2026-11-16T00:00:00Z", 4.0));
        Job::with_samples(server, person, &samples).await
    }

    /// Creates the order for a ship that has sent these samples.
    pub async fn with_samples(server: &TestServer, person: Person, samples: &[Sample]) -> Job {
        let ship = server.ship(&person, "Nao").await;
        ship.put(1, samples).await.good();
        server.advance(60.0);
        server.work().await;
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
        assert_eq!(made["has_binnacle"], true);
        made["id"].as_str().unwrap().clone_into(&mut job.order);
        job.confirm_as_found().await;
        job
    }

    /// Reports the correctors as they are recorded, with a sound compass.
    pub async fn confirm_as_found(&self) {
        let recorded = self.person.get(&self.path("/binnacle")).await.good();
        let found = as_found(&recorded["binnacle"]["setting"]);
        self.post("/as-found", &found).await.good();
    }

    /// Returns the body of a new order.
    pub fn new_order(&self) -> Value {
        json!({
            "vessel_id": self.ship.id, "compass_id": self.compass, "port": "Bilbao",
            "berth": "A5", "planned_at": "2026-11-21T09:00:00Z",
            "adjuster_name": "M. Etxeberria",
        })
    }

    /// Returns a path below the order.
    pub fn path(&self, rest: &str) -> String {
        format!("/work-orders/{}{rest}", self.order)
    }

    /// Posts to a path below the order.
    pub async fn post(&self, rest: &str, body: &Value) -> ApiResponse {
        self.person.post(&self.path(rest), body).await
    }

    /// Returns the order.
    pub async fn view_order(&self) -> Value {
        self.person.get(&self.path("")).await.good()
    }

    /// Reads the berth, chooses a plan, and does its steps as predicted.
    pub async fn adjust(&self) -> Value {
        self.post("/berth-reading", &reading()).await.good();
        self.follow_plan().await
    }

    /// Chooses a plan, and does its steps as predicted.
    pub async fn follow_plan(&self) -> Value {
        let mut order = self.post("/plan", &json!({})).await.good();
        while let Some(step) = order["next_step"].as_object() {
            let path = format!("/steps/{}", step["number"]);
            let after = json!({ "after_deg": step["expected_compass_deg"] });
            order = self.post(&path, &after).await.good();
            assert_ne!(order["last_step"]["verdict"], "unexplained", "{order}");
        }
        order
    }

    /// Adjusts and completes the order.
    pub async fn complete(&self) -> Value {
        self.adjust().await;
        self.post("/complete", &completion_details()).await.good()
    }

    /// Sends and analyses samples of days at sea by a model; returns the order.
    pub async fn sail(&mut self, server: &TestServer, ship: &Model, seq: u64, days: f64) -> Value {
        let samples = days_at_sea(ship, "2026-11-21T12:00:00Z", days);
        self.send(server, seq, &samples, days + 0.5).await;
        self.view_order().await
    }

    /// Sends and analyses samples a number of days from now.
    pub async fn send(&mut self, server: &TestServer, seq: u64, samples: &[Sample], days: f64) {
        server.advance(86_400.0 * days);
        self.ship.put(seq, samples).await.good();
        server.advance(60.0);
        server.work().await;
        // The session has expired.
        self.person = Person::sign_in(server, self.person.operator, &self.person.email).await;
    }

    /// Returns the open alerts.
    pub async fn open_alerts(&self) -> Vec<Value> {
        let found = self.person.get("/alerts?open=true").await.good();
        found["items"].as_array().unwrap().clone()
    }

    /// Downloads the evidence archive.
    pub async fn evidence(&self) -> Vec<u8> {
        let request = self
            .person
            .request(Method::GET, &self.path("/evidence.zip"));
        let response = request.send().await.unwrap();
        assert_eq!(response.status(), 200);
        response.bytes().await.unwrap().to_vec()
    }

    /// Returns the deviation card.
    pub async fn card(&self) -> Value {
        self.person.get(&self.ship.path("/card.json")).await.good()
    }

    /// Checks the card's status in each form: JSON, CSV, SVG.
    pub async fn expect_card_status(&self, status: &str) {
        let card = self.card().await;
        assert_eq!(card["status"], status, "{card}");
        let statement = card["statement"].as_str().unwrap();
        assert!(statement.contains("Not a certificate"), "{statement}");
        let csv = self.person.get(&self.ship.path("/card.csv")).await.text;
        let word = format!(",{status},");
        assert!(
            csv.lines().skip(1).all(|line| line.contains(&word)),
            "{csv}"
        );
        let svg = self.person.get(&self.ship.path("/card.svg")).await.text;
        let mark = match status {
            "verified" => "VERIFIED AT SEA – NOT A CERTIFICATE",
            _ => "PREDICTED – NOT A CERTIFICATE",
        };
        assert!(svg.contains(mark), "{mark}");
        assert!(svg.contains(&format!("Deviation card ({status})")));
    }

    /// Returns the card statuses of the deviation book's entries, in order.
    pub async fn book_statuses(&self, from: &str) -> Vec<Value> {
        let path = format!("/deviation-book?limit=200&from={from}");
        let book = self.person.get(&self.ship.path(&path)).await.good();
        let entries = book["items"].as_array().unwrap();
        entries.iter().map(|e| e["card_status"].clone()).collect()
    }

    /// Cancels the order and creates another one with these limits for the plan.
    pub async fn replace_order(&mut self, limits: Value) {
        self.post("/cancel", &json!({ "text": "other limits" }))
            .await
            .good();
        let mut order = self.new_order();
        order["limits"] = limits;
        let made = self.person.post("/work-orders", &order).await.good();
        made["id"].as_str().unwrap().clone_into(&mut self.order);
        self.confirm_as_found().await;
    }

    /// Posts something that is refused, and returns the code of the first refusal.
    pub async fn refusal_code(&self, rest: &str, body: &Value) -> Value {
        let response = self.post(rest, body).await;
        assert_eq!(response.problem(), "not-adjustable", "{response:?}");
        let refusal = response.json()["refusals"][0].clone();
        assert!(!refusal["cures"].as_array().unwrap().is_empty());
        assert!(!refusal["words"].as_str().unwrap().is_empty());
        refusal["refusal"].clone()
    }

    /// Uploads a photograph.
    pub async fn post_photo(&self, bytes: &'static [u8]) -> ApiResponse {
        let path = self.path("/photos?caption=trays");
        ApiResponse::send(self.person.request(Method::POST, &path).body(bytes)).await
    }

    /// Logs magnetic cargo, and returns the path that withdraws the entry.
    pub async fn load_steel(&self, from: &str) -> String {
        let steel = json!({ "kind": "magnetic_cargo", "from": from });
        let logbook = self.ship.path("/logbook");
        let entry = self.person.post(&logbook, &steel).await.good();
        format!("{logbook}/{}/withdraw", entry["id"].as_str().unwrap())
    }

    /// Withdraws a logbook entry.
    pub async fn withdraw(&self, path: &str) {
        let reason = json!({ "reason": "another ship" });
        self.person.post(path, &reason).await.good();
    }
}

/// Returns a report of correctors found in this setting, with a sound compass.
pub fn as_found(setting: &Value) -> Value {
    let spheres = setting["quadrantal"].is_object();
    json!({
        "setting": setting,
        "dockside": {
            "bubble": "sound", "pivot": "sound", "gimbals": "sound", "lubber_line": "sound",
            "spheres_turned_deg": if spheres { json!(0.5) } else { json!(null) },
        },
    })
}

/// Returns the model that a completed order predicts.
pub fn predicted_model(order: &Value) -> Model {
    serde_json::from_value(order["completion"]["model"].clone()).unwrap()
}

/// Returns the body that completes an order.
pub fn completion_details() -> Value {
    json!({
        "adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114",
        "firm": "Nervión Compass", "signature": "M. Etxeberria",
    })
}

/// Returns the second reading with this corrector setting, when no corrector was in use
/// at the first one.
pub fn second_reading(setting: &Value) -> Value {
    second_reading_after(&reading(), setting)
}

/// Returns the second reading with this corrector setting, after another first reading.
pub fn second_reading_after(first: &Value, setting: &Value) -> Value {
    let setting: Setting = serde_json::from_value(setting.clone()).unwrap();
    let binnacle_on_board: Binnacle = serde_json::from_value(binnacle()).unwrap();
    let of_correctors = effect(&binnacle_on_board, &setting);
    let (magnetic_deg, earth) = at_berth();
    let earth = earth.in_ship_axes(magnetic_deg.to_radians());
    let part = |name: &str, axis: usize| {
        let induced: f64 = (0..3).map(|c| of_correctors.chi[axis][c] * earth[c]).sum();
        let added_ut = (of_correctors.b_nt[axis] + induced) / 1000.0;
        first[name].as_f64().unwrap() + added_ut
    };
    let mut repeated = json!({
        "at": AT, "unit": "microtesla",
        "forward": part("forward", 0), "starboard": part("starboard", 1),
    });
    if first["down"].is_number() {
        repeated["down"] = json!(part("down", 2));
    }
    repeated
}

/// Returns the magnetic heading and the earth's field at the berth.
pub fn at_berth() -> (f64, EarthField) {
    let position = Position::new(BERTH.0, BERTH.1).unwrap();
    let time = Timestamp::parse(AT).unwrap();
    let earth = field(FieldModel::Igrf14, position, 0.0, time).unwrap();
    let magnetic_deg = HEADING_DEG - earth.declination().degrees_east();
    (magnetic_deg, earth.for_ship())
}

/// Returns the berth reading on the ship of these tests, without error.
pub fn reading() -> Value {
    reading_on_ship(&true_model())
}

/// Returns the berth reading on a ship with this magnetism.
pub fn reading_on_ship(ship: &Model) -> Value {
    let (magnetic_deg, earth) = at_berth();
    let parameters = ship.parameters_over_lambda;
    let u = parameters.field_over_lambda(magnetic_deg.to_radians(), earth);
    let [forward, starboard] = u.map(|part| LAMBDA * part / 1000.0);
    // A compass points along the field.
    let compass_deg = (-starboard).atan2(forward).to_degrees().rem_euclid(360.0);
    json!({
        "at": AT, "lat": BERTH.0, "lon": BERTH.1, "heading_true_deg": HEADING_DEG,
        "heading_from": "ashore", "forward": forward, "starboard": starboard,
        "unit": "microtesla", "magnetometer": "fluxgate", "compass_deg": compass_deg,
    })
}

/// Encodes bytes in hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    let digits = |text: String, byte: &u8| text + &format!("{byte:02x}");
    bytes.iter().fold(String::new(), digits)
}
