//! The server's API, as used by an operator's administrator.

use anyhow::{Context, Result, ensure};
use binnacle_compass::time::Timestamp;
use binnacle_simulator::scenario::ShipPlan;
use binnacle_simulator::truth::Place;
use reqwest::{Client, Method, RequestBuilder, StatusCode};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::time::Duration;

const TIMEOUT: Duration = Duration::from_mins(1);

/// A signed-in session.
pub(super) struct ServerApi {
    server: String,
    client: Client,
    cookie: String,
}

/// The server's state of a vessel.
#[derive(Debug, Deserialize)]
pub(super) struct VesselState {
    pub(super) last_position: Option<LastPosition>,
    pub(super) model: Option<ModelState>,
}

#[derive(Debug, Deserialize)]
pub(super) struct LastPosition {
    pub(super) at: Timestamp,
}

#[derive(Debug, Deserialize)]
pub(super) struct ModelState {
    pub(super) version: u64,
    pub(super) data_until: Timestamp,
}

/// Uploads received from a vessel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Uploads {
    pub(super) batches: u64,
    pub(super) samples: u64,
}

/// One row of a deviation table.
#[allow(clippy::struct_field_names, reason = "units stand in names")]
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct Predicted {
    pub(super) compass_deg: f64,
    pub(super) deviation_deg: f64,
    pub(super) band95_deg: Option<f64>,
}

#[derive(Deserialize)]
struct Items<T> {
    items: Vec<T>,
}

#[derive(Deserialize)]
struct AgentStream {
    batches: u64,
    samples: u64,
}

#[derive(Deserialize)]
struct DeviationTable {
    rows: Vec<Predicted>,
}

impl ServerApi {
    pub(super) async fn sign_in(server: &str, email: &str, password: &str) -> Result<ServerApi> {
        let server = server.trim_end_matches('/').to_owned();
        let client = Client::builder().timeout(TIMEOUT).build()?;
        let response = client
            .post(format!("{server}/api/v1/session"))
            .json(&json!({"email": email, "password": password}))
            .send()
            .await
            .with_context(|| format!("cannot reach {server}"))?;
        let cookies = response.headers().get_all("set-cookie").iter();
        let cookie = cookies
            .filter_map(|cookie| cookie.to_str().ok())
            .filter_map(|cookie| cookie.split(';').next())
            // Only for https does its name begin with `__Host-`.
            .find(|cookie| cookie.contains("binnacle_session="))
            .map(str::to_owned);
        read::<Value>(response).await.context("signing in")?;
        let cookie = cookie.context("signing in: the server gave no session cookie")?;
        Ok(ServerApi {
            server,
            client,
            cookie,
        })
    }

    pub(super) fn server(&self) -> &str {
        &self.server
    }

    pub(super) async fn create_vessel(&self, plan: &ShipPlan) -> Result<String> {
        let vessel = json!({
            "name": plan.name,
            "imo_number": plan.imo_number,
            "call_sign": plan.call_sign,
            "flag": plan.flag,
        });
        let made: Value = self.post("/vessels", &vessel).await?;
        text(&made, "id")
    }

    pub(super) async fn create_enrolment_code(&self, vessel: &str) -> Result<String> {
        let made: Value = self
            .post(&format!("/vessels/{vessel}/agents"), &json!({}))
            .await?;
        text(&made, "code")
    }

    pub(super) async fn vessel(&self, vessel: &str) -> Result<VesselState> {
        self.get(&format!("/vessels/{vessel}")).await
    }

    pub(super) async fn uploads(&self, vessel: &str) -> Result<Uploads> {
        let streams: Items<AgentStream> = self.get(&format!("/vessels/{vessel}/agents")).await?;
        Ok(streams
            .items
            .iter()
            .fold(Uploads::default(), |sum, stream| Uploads {
                batches: sum.batches + stream.batches,
                samples: sum.samples + stream.samples,
            }))
    }

    /// Returns the model's deviation at a place and time, every ten degrees;
    /// `None` without a model.
    pub(super) async fn deviation(
        &self,
        vessel: &str,
        place: &Place,
    ) -> Result<Option<Vec<Predicted>>> {
        let Place { lat, lon, at, .. } = place;
        let path = format!("/vessels/{vessel}/deviation?lat={lat}&lon={lon}&at={at}&step_deg=10");
        let response = self.request(Method::GET, &path).send().await?;
        if response.status() == StatusCode::NOT_FOUND {
            return Ok(None);
        }
        let table: DeviationTable = read(response).await?;
        Ok(Some(table.rows))
    }

    /// Returns the status from an agent's local page.
    pub(super) async fn agent_status(&self, page: std::net::SocketAddr) -> Result<Value> {
        read(
            self.client
                .get(format!("http://{page}/api/status"))
                .send()
                .await?,
        )
        .await
    }

    async fn get<T: DeserializeOwned>(&self, path: &str) -> Result<T> {
        let response = self.request(Method::GET, path).send().await?;
        read(response).await.with_context(|| format!("GET {path}"))
    }

    async fn post<T: DeserializeOwned>(&self, path: &str, body: &Value) -> Result<T> {
        let response = self.request(Method::POST, path).json(body).send().await?;
        read(response).await.with_context(|| format!("POST {path}"))
    }

    fn request(&self, method: Method, path: &str) -> RequestBuilder {
        self.client
            .request(method, format!("{}/api/v1{path}", self.server))
            .header("cookie", &self.cookie)
            .header("x-binnacle-request", "1")
    }
}

/// Returns the content of a response, or its problem as an error.
async fn read<T: DeserializeOwned>(response: reqwest::Response) -> Result<T> {
    let status = response.status();
    let body = response.bytes().await?;
    if status.is_success() {
        return serde_json::from_slice(&body).context("unexpected response");
    }
    let problem: Value = serde_json::from_slice(&body).unwrap_or_default();
    let detail = problem["detail"]
        .as_str()
        .or(problem["title"].as_str())
        .unwrap_or("");
    ensure!(status.is_success(), "{status} {detail}");
    unreachable!("a response either succeeds or fails")
}

fn text(value: &Value, field: &str) -> Result<String> {
    let text = value[field].as_str();
    Ok(text
        .with_context(|| format!("the response has no {field}"))?
        .to_owned())
}
