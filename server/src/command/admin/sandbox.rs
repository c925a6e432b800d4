//! Sandbox: an operator and a firm to practise with, and a compass to be adjusted.
//!
//! Invariants: it is made by the API's own requests, so that nothing in it could not be made by
//! a client. Its ship is simulated and says so in its name. Equal times give equal ships.

use crate::command::ingest::{Import, import_samples};
use crate::routes;
use crate::state::ServerState;
use anyhow::{Context, Result, ensure};
use axum::Router;
use axum::body::{Body, to_bytes};
use axum::http::header::{AUTHORIZATION, CONTENT_TYPE, COOKIE, SET_COOKIE};
use axum::http::{Method, Request};
use binnacle_adjustment::binnacle::SHIPPED;
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::model::Model;
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_fleet::operators;
use binnacle_orders::firms;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::ids::{FirmId, OperatorId, VesselId};
use binnacle_platform::secret::{self, HashMemory};
use binnacle_platform::session::{self, Role};
use binnacle_platform::tenants::Tenant;
use serde::Serialize;
use serde_json::{Value, json};
use tower::ServiceExt;

/// Longest response to read, bytes.
const MAX_BYTES: usize = 1 << 20;
/// Days that the ship has sailed.
const DAYS: f64 = 20.0;
/// Turning points of the voyage, degrees north and east: two magnetic latitudes, without which
/// induced and permanent magnetism cannot be separated. The ship ends off the berth.
const TURNS: [(f64, f64); 2] = [(43.4, -3.1), (10.0, -25.0)];
/// Berth, degrees north and east, and heading there, degrees true.
const BERTH: (f64, f64, f64) = (43.35, -3.04, 40.0);
/// The ship's λ, which only the reading at the berth shows.
const LAMBDA: f64 = 0.9;

/// Sandbox that was made.
#[derive(Debug, Serialize)]
pub struct Sandbox {
    /// Operator's admin.
    pub operator: Account,
    /// Firm's adjuster.
    pub firm: Account,
    /// Simulated ship.
    pub vessel_id: VesselId,
    /// Order that is offered to the firm.
    pub order_id: String,
    /// Report of the correctors as found, to send before the plan.
    pub as_found: Value,
    /// Reading to send at the berth.
    pub berth_reading: Value,
}

/// User of a sandbox, and a token that acts for them.
#[derive(Debug, Serialize)]
pub struct Account {
    /// Id of the operator or firm.
    pub id: uuid::Uuid,
    /// Address to sign in with.
    pub email: String,
    /// Password.
    pub password: String,
    /// API token with the scope `write`.
    pub token: String,
}

/// Creates a sandbox. The ship's model follows with the server's next analyses.
///
/// # Errors
/// Fails when the database fails.
pub async fn create_sandbox(app: &App, name: &str) -> Result<Sandbox> {
    let router = routes::router(&ServerState::new(app.clone()));
    let request =
        RequestContext::of_command(&app.db, "admin create sandbox", app.clock.now().into());
    let (operator, firm) = create_tenants(app, &request, name).await?;
    let operator_account =
        create_account(app, &request, &router, operator.into(), "officer").await?;
    let firm_account = create_account(app, &request, &router, firm.into(), "adjuster").await?;
    let office = Client {
        router: &router,
        token: operator_account.token.clone(),
    };
    let ship = json!({ "name": "Sandbox (simulated)" });
    let vessel = office.send(Method::POST, "/vessels", &ship).await?;
    let vessel_id: VesselId = serde_json::from_value(vessel["id"].clone())?;
    let compass = &vessel["compasses"][0]["id"];
    let model = magnetism()?;
    let now = app.clock.now();
    let import = Import {
        vessel: vessel_id,
        compass: None,
        samples: voyage(&model, now)?,
    };
    import_samples(&app.db, import, now.into(), |_| ()).await?;
    app.work.notify_one();
    let compass_path = compass.as_str().context("a compass has an id")?;
    let path = format!("/vessels/{vessel_id}/compasses/{compass_path}/binnacle");
    office.send(Method::PUT, &path, &binnacle()?).await?;
    let order = json!({
        "vessel_id": vessel_id, "compass_id": compass, "port": "Bilbao", "berth": "A5",
        "planned_at": now.plus_seconds(2.0 * 86_400.0),
        "offer": { "firms": [firm], "answer_within_hours": 720 },
    });
    let order = office.send(Method::POST, "/work-orders", &order).await?;
    Ok(Sandbox {
        operator: operator_account,
        firm: firm_account,
        vessel_id,
        order_id: order["id"]
            .as_str()
            .context("an order has an id")?
            .to_owned(),
        as_found: json!({
            "setting": binnacle()?["setting"],
            "dockside": {
                "bubble": "sound", "pivot": "sound", "gimbals": "sound", "lubber_line": "sound",
                "spheres_turned_deg": null,
            },
        }),
        berth_reading: berth_reading(&model, now)?,
    })
}

async fn create_tenants(
    app: &App,
    request: &RequestContext,
    name: &str,
) -> Result<(OperatorId, FirmId)> {
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let operator = operators::create(&mut tx, name, now).await?;
    let firm = firms::create(&mut tx, &format!("{name}: adjusters"), now).await?;
    firms::engage(&mut tx, operator, firm, now).await?;
    tx.commit().await?;
    Ok((operator, firm))
}

/// Creates a user of a tenant, and a token as the user would.
async fn create_account(
    app: &App,
    request: &RequestContext,
    router: &Router,
    tenant: Tenant,
    who: &str,
) -> Result<Account> {
    let role = match tenant {
        Tenant::Operator(_) => Role::Admin,
        Tenant::Firm(_) => Role::Adjuster,
    };
    let email = format!("{who}.{}@sandbox.invalid", tenant.id().simple());
    let password = secret::new_password();
    let hash = secret::hash_password(&password, &mut HashMemory::default())?;
    let name = format!("Sandbox {who}");
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    session::create_user(&mut tx, Some(tenant), &email, &name, role, &hash, now).await?;
    request.concerns(tenant);
    tx.commit().await?;
    let credentials = json!({ "email": email, "password": password }).to_string();
    let sign_in = Request::post("/api/v1/session")
        .header(CONTENT_TYPE, "application/json")
        .body(Body::from(credentials))?;
    let response = router.clone().oneshot(sign_in).await?;
    let cookie = response
        .headers()
        .get(SET_COOKIE)
        .context("sign-in sets a cookie")?;
    let cookie = cookie
        .to_str()?
        .split(';')
        .next()
        .unwrap_or_default()
        .to_owned();
    let new = Request::post("/api/v1/tokens")
        .header(CONTENT_TYPE, "application/json")
        .header(COOKIE, cookie)
        .header("X-Binnacle-Request", "1")
        .body(Body::from(
            json!({ "name": "Sandbox", "scope": "write" }).to_string(),
        ))?;
    let made = read(router.clone().oneshot(new).await?).await?;
    let token = made["token"]
        .as_str()
        .context("a token is shown")?
        .to_owned();
    Ok(Account {
        id: tenant.id(),
        email,
        password,
        token,
    })
}

/// Client of this process's own API.
struct Client<'a> {
    router: &'a Router,
    token: String,
}

impl Client<'_> {
    async fn send(&self, method: Method, path: &str, body: &Value) -> Result<Value> {
        let request = Request::builder()
            .method(method)
            .uri(format!("/api/v1{path}"))
            .header(CONTENT_TYPE, "application/json")
            .header(AUTHORIZATION, format!("Bearer {}", self.token))
            .body(Body::from(body.to_string()))?;
        read(self.router.clone().oneshot(request).await?).await
    }
}

async fn read(response: axum::response::Response) -> Result<Value> {
    let status = response.status();
    let bytes = to_bytes(response.into_body(), MAX_BYTES).await?;
    let text = String::from_utf8_lossy(&bytes);
    ensure!(status.is_success(), "the API responded {status}: {text}");
    Ok(serde_json::from_slice(&bytes)?)
}

/// Returns the magnetism of the ship: within what correctors can compensate.
fn magnetism() -> Result<Model> {
    Ok(serde_json::from_value(json!({ "parameters_over_lambda": {
        "bx_nt": 1400.0, "chi13": -0.01, "by_nt": -800.0, "chi23": 0.002,
        "chi11_minus_chi22": 0.035, "chi12": 0.001, "chi21": 0.002,
    }}))?)
}

/// Returns a binnacle with trays, spheres and a Flinders bar, none of them in use.
fn binnacle() -> Result<Value> {
    let (_, design) = SHIPPED[0];
    Ok(json!({
        "version": 1, "serial": "sandbox",
        "type": serde_json::from_str::<Value>(design)?,
        "aboard": {
            "magnets": [{ "magnet": "200 mm", "count": 12 }],
            "quadrantal": ["7 inch"],
            "flinders_pieces_mm": [300, 150, 75, 75],
        },
        "setting": {},
    }))
}

/// Returns a sample every ten minutes of a voyage that ends now, with a new heading every three
/// hours.
fn voyage(ship: &Model, now: Timestamp) -> Result<Vec<Sample>> {
    let samples = (DAYS * 144.0) as u32;
    (0..samples)
        .map(|i| {
            let time = now.plus_seconds(600.0 * (f64::from(i) - f64::from(samples)));
            // Out and back again between the turning points.
            let share = 1.0 - (2.0 * f64::from(i) / f64::from(samples) - 1.0).abs();
            let [from, to] = TURNS;
            let between = |from: f64, to: f64| from + share * (to - from);
            let position = Position::new(between(from.0, to.0), between(from.1, to.1));
            let position = position.context("the voyage is on the earth")?;
            sample(ship, position, time, 107.0 * f64::from(i / 18), i)
        })
        .collect()
}

fn sample(
    ship: &Model,
    position: Position,
    time: Timestamp,
    heading_deg: f64,
    number: u32,
) -> Result<Sample> {
    let earth = field(FieldModel::Igrf14, position, 0.0, time)?;
    let heading = TrueHeading::new(heading_deg).context("a heading is finite")?;
    let compass = ship
        .compass_for_true(heading, earth.declination(), earth.for_ship())
        .context("the compass points")?;
    let read_deg = compass.degrees() + 0.4 * unevenness(3 * number);
    let gyro_deg = heading_deg + 0.3 * unevenness(3 * number + 1);
    let satellite_deg = heading_deg + 0.3 * unevenness(3 * number + 2);
    let compass = CompassHeading::new(read_deg).context("a heading is finite")?;
    Ok(Sample {
        gyro: TrueHeading::new(gyro_deg),
        satellite: TrueHeading::new(satellite_deg),
        sog_kn: Some(12.0),
        spread_deg: Some(0.3),
        windows: 60,
        ..Sample::new(time, position, compass)
    })
}

/// Returns a reproducible number between -1 and 1: instruments never agree to the last digit.
fn unevenness(number: u32) -> f64 {
    let mixed = number.wrapping_mul(0x9E37_79B1) ^ (number >> 7);
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x85EB_CA77);
    f64::from(mixed ^ (mixed >> 13)) / f64::from(u32::MAX) * 2.0 - 1.0
}

/// Returns what a magnetometer and the compass read at the berth.
fn berth_reading(ship: &Model, at: Timestamp) -> Result<Value> {
    let (lat, lon, heading_deg) = BERTH;
    let position = Position::new(lat, lon).context("the berth is on the earth")?;
    let earth = field(FieldModel::Igrf14, position, 0.0, at)?;
    let magnetic_deg = heading_deg - earth.declination().degrees_east();
    let parameters = ship.parameters_over_lambda;
    let over_lambda = parameters.field_over_lambda(magnetic_deg.to_radians(), earth.for_ship());
    let [forward, starboard] = over_lambda.map(|part| LAMBDA * part / 1000.0);
    // A compass points along the field.
    let compass_deg = (-starboard).atan2(forward).to_degrees().rem_euclid(360.0);
    Ok(json!({
        "at": at, "lat": lat, "lon": lon, "heading_true_deg": heading_deg,
        "heading_from": "ashore", "forward": forward, "starboard": starboard,
        "unit": "microtesla", "magnetometer": "fluxgate", "compass_deg": compass_deg,
    }))
}
