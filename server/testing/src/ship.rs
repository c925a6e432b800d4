//! A ship with an enrolled agent, whose batches the test makes.

use crate::person::{ApiResponse, Person};
use crate::server::TestServer;
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::model::Model;
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_wire::batch::{Batch, StreamId};
use binnacle_wire::messages::{Downlink, EnrolResponse};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A ship and its agent.
pub struct Ship {
    url: String,
    http: reqwest::Client,
    /// Id of the vessel.
    pub id: String,
    /// Token of the agent.
    pub token: String,
    /// Stream of the agent.
    pub stream: StreamId,
}

impl TestServer {
    /// Creates a vessel of the person's operator and enrols an agent.
    pub async fn ship(&self, person: &Person, name: &str) -> Ship {
        Ship::enrol(self, person, name).await
    }
}

impl Ship {
    pub(crate) async fn enrol(server: &TestServer, person: &Person, name: &str) -> Ship {
        let vessel = person.create_vessel(name).await;
        let id = vessel["id"].as_str().unwrap().to_owned();
        let code = person
            .post(&format!("/vessels/{id}/agents"), &json!({}))
            .await
            .good();
        let enrolled = enrol_with_code(server, code["code"].as_str().unwrap())
            .await
            .good();
        let enrolled: EnrolResponse = serde_json::from_value(enrolled).unwrap();
        Ship {
            url: server.url.clone(),
            http: server.http.clone(),
            id,
            token: enrolled.token,
            stream: enrolled.stream,
        }
    }

    /// Continues with a server that was restarted.
    pub fn reconnect(&mut self, server: &TestServer) {
        self.url.clone_from(&server.url);
    }

    /// Sends a batch of samples.
    pub async fn put(&self, seq: u64, samples: &[Sample]) -> ApiResponse {
        self.put_bytes(seq, frame(self.stream, seq, samples)).await
    }

    /// Sends bytes as a batch.
    pub async fn put_bytes(&self, seq: u64, bytes: Vec<u8>) -> ApiResponse {
        let path = format!("/streams/{}/batches/{seq}", self.stream);
        ApiResponse::send(self.request(reqwest::Method::PUT, &path).body(bytes)).await
    }

    /// Reads the downlink in its JSON form; `has` is the query.
    pub async fn downlink(&self, has: &str) -> Value {
        let path = format!("/streams/{}/downlink{has}", self.stream);
        ApiResponse::send(self.request(reqwest::Method::GET, &path))
            .await
            .good()
    }

    /// Returns the downlink in its compact form, and its length in bytes.
    pub async fn compact_downlink(&self, has: &str) -> (Downlink, usize) {
        let path = format!("/streams/{}/downlink?form=1{has}", self.stream);
        let response = self.request(reqwest::Method::GET, &path).send().await;
        let response = response.unwrap();
        assert_eq!(response.headers().get("content-type"), None);
        let bytes = response.bytes().await.unwrap();
        (
            binnacle_wire::downlink::decode(&bytes).unwrap(),
            bytes.len(),
        )
    }

    /// Builds a request of the agent.
    pub fn request(&self, method: reqwest::Method, path: &str) -> reqwest::RequestBuilder {
        self.http
            .request(method, format!("{}/api/v1{path}", self.url))
            .bearer_auth(&self.token)
    }

    /// Returns a path below the vessel.
    pub fn path(&self, rest: &str) -> String {
        format!("/vessels/{}{rest}", self.id)
    }

    /// Enters a logbook entry as a person.
    pub async fn report(&self, person: &Person, entry: &Value) -> Value {
        person.post(&self.path("/logbook"), entry).await.good()
    }

    /// Sends a logbook report as the agent.
    pub async fn put_report(&self, id: &str, report: &Value) -> ApiResponse {
        let path = format!("/agents/logbook/{id}");
        ApiResponse::send(self.request(reqwest::Method::PUT, &path).json(report)).await
    }

    /// Sends an azimuth as the agent.
    pub async fn put_azimuth(&self, id: &str, azimuth: &Value) -> ApiResponse {
        let path = format!("/agents/azimuths/{id}");
        ApiResponse::send(self.request(reqwest::Method::PUT, &path).json(azimuth)).await
    }
}

/// Returns an azimuth: the sun in the forenoon of the day before the tests' present.
pub fn sun_by_azimuth() -> Value {
    json!({
        "time": "2026-11-20T10:00:00Z", "lat": 43.4, "lon": -3.1, "kind": "sun_azimuth",
        "compass_heading_deg": 92.0, "compass_bearing_deg": 150.0, "gyro_heading_deg": 94.0,
        "observer": "LW",
    })
}

/// Sends an enrolment request.
pub async fn enrol_with_code(server: &TestServer, code: &str) -> ApiResponse {
    let request = server
        .http
        .post(format!("{}/api/v1/agents/enrol", server.url))
        .json(&json!({ "code": code, "agent_version": "1.2.3" }));
    ApiResponse::send(request).await
}

/// Returns the bytes of a batch.
pub fn frame(stream: StreamId, seq: u64, samples: &[Sample]) -> Vec<u8> {
    let batch = Batch {
        stream,
        seq,
        samples: samples.to_vec(),
        tally: BTreeMap::from([("accepted".to_owned(), 60 * samples.len() as u64)]),
        alerts: Vec::new(),
        thinned: None,
    };
    binnacle_wire::encode(&batch).unwrap()
}

/// Returns a position, degrees north and east.
pub fn position(lat: f64, lon: f64) -> Position {
    Position::new(lat, lon).unwrap()
}

/// Returns the default position of the ships.
fn biscay() -> Position {
    position(48.0, -6.0)
}

/// Returns the known magnetism of the ships.
pub fn true_model() -> Model {
    serde_json::from_value(json!({ "parameters_over_lambda": {
        "bx_nt": 1500.0, "chi13": -0.01, "by_nt": -900.0, "chi23": 0.002,
        "chi11_minus_chi22": 0.04, "chi12": 0.001, "chi21": 0.002,
    }}))
    .unwrap()
}

/// Returns a sample of that ship on a true heading.
pub fn sample(time: Timestamp, heading_deg: f64) -> Sample {
    sample_of(&true_model(), biscay(), time, heading_deg)
}

/// Returns the known magnetism after a step in permanent magnetism, nT.
pub fn model_after_step(bx_nt: f64, by_nt: f64) -> Model {
    let mut ship = true_model();
    ship.parameters_over_lambda.bx_nt += bx_nt;
    ship.parameters_over_lambda.by_nt += by_nt;
    ship
}

fn sample_of(ship: &Model, position: Position, time: Timestamp, heading_deg: f64) -> Sample {
    let earth = field(FieldModel::Igrf14, position, 0.0, time).unwrap();
    let heading = TrueHeading::new(heading_deg).unwrap();
    let compass = ship
        .compass_for_true(heading, earth.declination(), earth.for_ship())
        .unwrap();
    Sample {
        gyro: Some(heading),
        sog_kn: Some(12.0),
        spread_deg: Some(0.3),
        windows: 60,
        ..Sample::new(time, position, compass)
    }
}

/// Returns ten-minute samples on all headings from a start time on.
pub fn passage(from: &str, samples: usize) -> Vec<Sample> {
    let start = Timestamp::parse(from).unwrap();
    (0..samples)
        .map(|i| {
            let mut sample = sample(start.plus_seconds(600.0 * i as f64), 37.0 * i as f64);
            // Independent instruments never agree to the last digit.
            let off = |sign: u32| 0.15 * unevenness(2 * i as u32 + sign);
            let compass_deg = sample.compass.degrees() + off(0);
            sample.compass = CompassHeading::new(compass_deg).unwrap();
            sample.gyro = TrueHeading::new(sample.gyro.unwrap().degrees() + off(1));
            sample
        })
        .collect()
}

/// Returns samples of a number of days at sea: legs of three hours, a sample every ten
/// minutes with both references, each with a small error.
pub fn days_at_sea(ship: &Model, from: &str, days: f64) -> Vec<Sample> {
    days_in_waters(biscay(), ship, from, days)
}

/// Returns such samples of a ship that ends at another position.
pub fn days_in_waters(position: Position, ship: &Model, from: &str, days: f64) -> Vec<Sample> {
    let start = Timestamp::parse(from).unwrap();
    let samples = (days * 144.0).round() as u32;
    let heading_deg = |i: u32| 107.0 * f64::from(i / 18);
    let mut track: Vec<Position> = vec![position];
    for i in (1..samples).rev() {
        track.push(sailed(track[track.len() - 1], heading_deg(i) + 180.0, 2.0));
    }
    track.reverse();
    (0..samples)
        .zip(track)
        .map(|(i, position)| {
            let time = start.plus_seconds(600.0 * f64::from(i));
            let mut sample = sample_of(ship, position, time, heading_deg(i));
            let off = |sign: u32, size_deg: f64| size_deg * unevenness(3 * i + sign);
            let compass_deg = sample.compass.degrees() + off(0, 0.4);
            sample.compass = CompassHeading::new(compass_deg).unwrap();
            let heading_deg = sample.gyro.unwrap().degrees();
            sample.gyro = TrueHeading::new(heading_deg + off(1, 0.3));
            sample.satellite = TrueHeading::new(heading_deg + off(2, 0.3));
            sample
        })
        .collect()
}

/// Returns the position after some miles on a heading.
fn sailed(from: Position, heading_deg: f64, miles: f64) -> Position {
    let (east, north) = heading_deg.to_radians().sin_cos();
    let lat = from.lat_deg() + miles / 60.0 * north;
    let lon = from.lon_deg() + miles / 60.0 * east / from.lat_deg().to_radians().cos();
    position(lat, lon)
}

/// Returns a reproducible pseudo-random number between -1 and 1.
fn unevenness(i: u32) -> f64 {
    let mixed = i.wrapping_mul(2_654_435_761) ^ 0x9E37_79B9;
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x85EB_CA6B);
    f64::from(mixed ^ (mixed >> 13)) / f64::from(u32::MAX) * 2.0 - 1.0
}
