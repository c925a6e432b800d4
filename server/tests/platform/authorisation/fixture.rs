//! Two operators, each with people, tokens, a firm, a ship, and one object of every kind.

use crate::second_factor;
use binnacle_platform::ids::FirmId;
use binnacle_platform::session::Role;
use binnacle_server_testing::alerts;
use binnacle_server_testing::binnacles::{binnacle, put};
use binnacle_server_testing::port_calls::call;
use binnacle_server_testing::work_orders::{PICTURE, hex};
use binnacle_server_testing::{ApiResponse, PASSWORD, Person, Ship, TestServer, sun_by_azimuth};
use reqwest::{Method, RequestBuilder};
use ring::signature::{Ed25519KeyPair, KeyPair};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Roles, in the order of a rule's signs.
pub(super) const ROLES: [&str; 9] = [
    "admin",
    "viewer",
    "admin's token that reads",
    "admin's token that writes",
    "adjuster",
    "adjuster's token that reads",
    "agent",
    "platform admin",
    "platform admin's token that reads",
];

/// Credentials of a request.
#[derive(Clone)]
pub(super) enum Key {
    Cookie(String),
    Token(String),
}

/// One operator with its people, firm and objects.
pub(super) struct Side {
    /// Credentials in the order of [`ROLES`].
    pub(super) keys: Vec<Key>,
    ids: BTreeMap<&'static str, String>,
    /// Id of a notification of each role, which is theirs alone.
    notifications: BTreeMap<usize, String>,
    /// Ids and names that nobody else may see.
    pub(super) marks: Vec<String>,
}

const EVERY_DAY: [&str; 7] = ["Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"];
/// An unknown id.
const NONE: &str = "019a0000-0000-7000-8000-000000000000";

impl Side {
    pub(super) async fn new(
        server: &TestServer,
        name: &str,
        root: Option<&[Key]>,
    ) -> (Side, Vec<Key>) {
        let admin = server.admin(name).await;
        let viewer = admin.viewer(server).await;
        let (firm, adjuster) = admin.adjuster(server, &format!("firm-{name}")).await;
        let ship = server.ship(&admin, &format!("ship-of-{name}")).await;
        let root = if let Some(keys) = root {
            keys.to_vec()
        } else {
            let root = admin.platform_admin(server).await;
            second_factor::set_up(server, &root).await;
            let token = token(&root, "read").await;
            vec![Key::Cookie(root.cookie), token.1]
        };
        for person in [&viewer, &adjuster] {
            second_factor::set_up(server, person).await;
        }
        let (_, codes) = second_factor::set_up(server, &admin).await;
        let read = token(&admin, "read").await;
        let write = token(&admin, "write").await;
        let firms = token(&adjuster, "read").await;
        alerts::report_departure(&ship).await;
        let mut ids = create_objects(&admin, &ship, &format!("{firm}")).await;
        ids.extend(create_order_objects(&admin, &adjuster, firm, &ids).await);
        ids.insert("colleague", colleague(server, &admin, &ship).await);
        ids.insert("firm", firm.to_string());
        ids.insert("operator", admin.operator.to_string());
        ids.insert("token", token(&admin, "read").await.0);
        second_factor::sign_in(server, &admin.email, &codes[0])
            .await
            .good();
        let sessions = admin.get("/sessions").await.good();
        let session = sessions["items"][1]["id"].as_str().unwrap();
        ids.insert("session", session.to_owned());
        let mut notifications = BTreeMap::new();
        for (role, person) in [(0, &admin), (1, &viewer), (3, &admin), (4, &adjuster)] {
            let listed = person.get("/notifications").await.good();
            notifications.insert(role, text(&listed["items"][0]["id"]));
        }
        let keys = vec![
            Key::Cookie(admin.cookie),
            Key::Cookie(viewer.cookie),
            read.1,
            write.1,
            Key::Cookie(adjuster.cookie),
            firms.1,
            Key::Token(ship.token),
        ];
        let keys: Vec<Key> = keys.into_iter().chain(root.clone()).collect();
        let mut marks: Vec<String> = ids.values().cloned().collect();
        marks.extend([format!("ship-of-{name}"), format!("{name}@example.com")]);
        let side = Side {
            keys,
            ids,
            notifications,
            marks,
        };
        (side, root)
    }

    /// Fills a path of the document with this side's ids for a role, or with unknown
    /// ids.
    pub(super) fn fill(&self, path: &str, role: usize, real: bool) -> String {
        let first = path.split('/').nth(1).unwrap();
        let of_id = match first {
            "notifications" => "notification",
            "alerts" => "alert",
            _ if path == "/users/{id}/second-factor" => "colleague",
            "vessels" => "vessel",
            "work-orders" => "order",
            "webhooks" => "webhook",
            "mail-recipients" => "recipient",
            "calendar-feeds" => "feed",
            "firms" => "firm",
            "operators" => "operator",
            "users" => "user",
            "sessions" => "session",
            "tokens" => "token",
            _ => "",
        };
        let mut filled = path.to_owned();
        for name in [
            "id", "compass", "agent", "stream", "entry", "azimuth", "call", "firm", "key",
            "delivery", "photo",
        ] {
            let key = match (name, first) {
                ("id", _) => of_id,
                ("delivery", "mail-recipients") => "letter",
                _ => name,
            };
            let notification = self
                .notifications
                .get(&role)
                .filter(|_| key == "notification");
            let id = notification.or_else(|| self.ids.get(key)).filter(|_| real);
            let id = id.map_or(NONE, String::as_str);
            filled = filled.replace(&format!("{{{name}}}"), id);
        }
        filled
            .replace("{seq}", "1")
            .replace("{version}", "1")
            .replace("{n}", "1")
            .replace("{name}", "class_a_trays")
            .replace("{quota}", "users")
    }

    /// Returns a body for an operation, with this side's ids.
    pub(super) fn body(&self, operation: &str) -> Value {
        let (vessel, compass, firm) =
            (&self.ids["vessel"], &self.ids["compass"], &self.ids["firm"]);
        match operation {
            "POST /work-orders" => json!({
                "vessel_id": vessel, "compass_id": compass, "port": "Bilbao",
                "planned_at": "2026-11-22T08:00:00Z",
            }),
            "PATCH /notifications/{id}" => json!({ "read": true }),
            "POST /calendar-feeds" => json!({ "name": "Fleet" }),
            "POST /webhooks" | "PUT /webhooks/{id}" => {
                json!({ "url": "https://erp.example.com/", "kinds": ["alert.raised"] })
            }
            "PUT /operators/{id}/quotas/{quota}" => json!({ "most": 1000 }),
            "POST /tokens" => json!({ "name": "ERP", "scope": "read" }),
            "POST /firms" | "POST /operators" => json!({ "name": "New" }),
            "POST /firms/{id}/users" | "POST /operators/{id}/users" => {
                json!({ "email": "new@example.com", "name": "New" })
            }
            "PUT /me/fleet-views" => json!({ "items": [] }),
            "PUT /me/password" => {
                json!({ "current": PASSWORD, "new": "seven gulls over the quay" })
            }
            "POST /me/second-factor"
            | "POST /me/second-factor/recovery-codes"
            | "POST /me/second-factor/remove" => json!({ "password": PASSWORD }),
            "POST /me/second-factor/confirm" => json!({ "code": "000000" }),
            "POST /firms/{id}/keys" => json!({
                "name": "K", "public_key": "0".repeat(64), "proof": "0".repeat(128),
            }),
            "POST /schedule/pins" => pin(&self.ids),
            "POST /work-orders/{id}/offer" => json!({ "firms": [firm] }),
            "POST /work-orders/{id}/cancel"
            | "POST /work-orders/{id}/close"
            | "POST /work-orders/{id}/remarks"
            | "POST /work-orders/{id}/messages" => {
                json!({ "text": "x" })
            }
            "POST /vessels/{id}/port-calls" => call("NLRTM", 20),
            "POST /vessels/{id}/azimuths" => sun_by_azimuth(),
            "PUT /vessels/{id}/compasses/{compass}/binnacle" => binnacle(),
            "POST /vessels/{id}/compasses" => json!({ "name": "Aft", "role": "steering" }),
            _ => json!({}),
        }
    }
}

/// Creates one object of every kind that an operator owns.
async fn create_objects(admin: &Person, ship: &Ship, firm: &str) -> BTreeMap<&'static str, String> {
    let vessel = ship.id.clone();
    let agents = admin.get(&ship.path("/agents")).await.good();
    let compasses = admin.get(&ship.path("/compasses")).await.good();
    let compass = text(&compasses["items"][0]["id"]);
    let entry = json!({ "kind": "lightning", "from": "2026-11-20T00:00:00Z" });
    let entry = admin.post(&ship.path("/logbook"), &entry).await.good();
    let azimuth = ship.path("/azimuths");
    let azimuth = admin.post(&azimuth, &sun_by_azimuth()).await.good();
    let port_call = call("NLRTM", 8);
    let port_call = admin
        .post(&ship.path("/port-calls"), &port_call)
        .await
        .good();
    let kept = ship.path(&format!("/compasses/{compass}/binnacle"));
    put(admin, &kept, &binnacle()).await.good();
    let webhook = json!({ "url": "https://erp.example.com/", "kinds": ["order.offered"] });
    let webhook = admin.post("/webhooks", &webhook).await.good();
    let known = json!({ "flag_state": "NO", "gross_tonnage": 24000 });
    put(admin, &ship.path("/particulars"), &known).await.good();
    let terms =
        json!({ "fee_eur": 1800, "ports": [{ "port": "NLRTM" }], "working_days": EVERY_DAY });
    put(admin, &format!("/firms/{firm}/terms"), &terms)
        .await
        .good();
    let order = json!({
        "vessel_id": vessel, "compass_id": compass, "port": "Bilbao",
        "planned_at": "2026-11-22T08:00:00Z", "offer": { "firms": [firm] },
    });
    let order = admin.post("/work-orders", &order).await.good();
    let deliveries = format!("/webhooks/{}/deliveries", text(&webhook["id"]));
    let deliveries = admin.get(&deliveries).await.good();
    admin.post("/schedule/solve", &json!({})).await.good();
    let recipient = json!({ "address": format!("office-{vessel}@example.com") });
    let recipient = admin.post("/mail-recipients", &recipient).await.good();
    let tried = format!("/mail-recipients/{}/test", text(&recipient["id"]));
    admin.post(&tried, &json!({})).await;
    let letters = format!("/mail-recipients/{}/deliveries", text(&recipient["id"]));
    let letters = admin.get(&letters).await.good();
    let alerts = admin.get("/alerts").await.good();
    let feed = json!({ "name": "Fleet" });
    let feed = admin.post("/calendar-feeds", &feed).await.good();
    let user =
        json!({ "email": format!("mate-{vessel}@example.com"), "name": "Mate", "role": "viewer" });
    let user = admin.post("/users", &user).await.good();
    BTreeMap::from([
        ("agent", text(&agents["items"][0]["agent_id"])),
        ("stream", ship.stream.to_string()),
        ("vessel", vessel),
        ("compass", compass),
        ("entry", text(&entry["id"])),
        ("azimuth", text(&azimuth["id"])),
        ("call", text(&port_call["id"])),
        ("order", text(&order["id"])),
        ("webhook", text(&webhook["id"])),
        ("delivery", text(&deliveries["items"][0]["id"])),
        ("recipient", text(&recipient["id"])),
        ("letter", text(&letters["items"][0]["id"])),
        ("alert", text(&alerts["items"][0]["id"])),
        ("feed", text(&feed["id"])),
        ("user", text(&user["user"]["id"])),
    ])
}

/// Creates a key of the firm, a photograph of an order, and a pin.
async fn create_order_objects(
    admin: &Person,
    adjuster: &Person,
    firm: FirmId,
    ids: &BTreeMap<&'static str, String>,
) -> [(&'static str, String); 2] {
    let seed: [u8; 32] = std::array::from_fn(|place| firm.0.as_bytes()[place % 16]);
    let pair = Ed25519KeyPair::from_seed_unchecked(&seed).unwrap();
    let proof = pair.sign(format!("binnacle firm key {firm}").as_bytes());
    let key = json!({
        "name": "Office", "public_key": hex(pair.public_key().as_ref()),
        "proof": hex(proof.as_ref()),
    });
    let key = adjuster
        .post(&format!("/firms/{firm}/keys"), &key)
        .await
        .good();
    let order = format!("/work-orders/{}", ids["order"]);
    let yes = json!({ "adjuster_name": "M. Etxeberria" });
    adjuster.post(&format!("{order}/accept"), &yes).await.good();
    let photos = format!("{order}/photos?caption=trays");
    let photo = admin.request(Method::POST, &photos).body(PICTURE);
    let photo = ApiResponse::send(photo).await.good();
    let mut all = ids.clone();
    all.insert("firm", firm.to_string());
    admin.post("/schedule/pins", &pin(&all)).await.good();
    [
        ("key", text(&key["id"])),
        ("photo", text(&photo["photos"][0]["photo"])),
    ]
}

fn pin(ids: &BTreeMap<&'static str, String>) -> Value {
    json!({
        "compass_id": ids["compass"], "call_id": ids["call"], "firm_id": ids["firm"],
        "day": "2026-12-08",
    })
}

/// Creates a colleague with a second factor that can be removed; returns the id.
async fn colleague(server: &TestServer, admin: &Person, ship: &Ship) -> String {
    let email = format!("purser-{}@example.com", ship.id);
    Person::create(server, Some(admin.operator.into()), &email, Role::Viewer).await;
    let purser = Person::sign_in(server, admin.operator, &email).await;
    second_factor::set_up(server, &purser).await;
    text(&purser.get("/me").await.good()["user_id"])
}

#[track_caller]
fn text(value: &Value) -> String {
    let text = value.as_str();
    text.unwrap_or_else(|| panic!("no text: {value}"))
        .to_owned()
}

/// Creates a token; returns its id and credentials.
async fn token(person: &Person, scope: &str) -> (String, Key) {
    let new = json!({ "name": "ERP", "scope": scope });
    let made = person.post("/tokens", &new).await.good();
    let secret = made["token"].as_str().unwrap().to_owned();
    (made["id"].as_str().unwrap().to_owned(), Key::Token(secret))
}

/// Builds a request with credentials, or without.
pub(super) fn request(
    server: &TestServer,
    key: Option<&Key>,
    method: &str,
    path: &str,
) -> RequestBuilder {
    let method = Method::from_bytes(method.as_bytes()).unwrap();
    let request = server.http.request(method, format!("{}{path}", server.url));
    match key {
        Some(Key::Cookie(cookie)) => request
            .header("cookie", cookie)
            .header("x-binnacle-request", "1"),
        Some(Key::Token(token)) => request.bearer_auth(token),
        None => request,
    }
}

/// Returns the response; of live events, which have no end, only the start.
pub(super) async fn response(request: RequestBuilder) -> ApiResponse {
    let response = request.send().await.unwrap();
    let (status, headers) = (response.status().as_u16(), response.headers().clone());
    let endless = headers
        .get("content-type")
        .is_some_and(|kind| kind == "text/event-stream");
    let bytes = if endless {
        Vec::new()
    } else {
        response.bytes().await.unwrap().to_vec()
    };
    let text = String::from_utf8_lossy(&bytes).into_owned();
    ApiResponse {
        status,
        headers,
        text,
    }
}
