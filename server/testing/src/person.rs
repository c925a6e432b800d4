//! A signed-in person with a browser.

use crate::server::{PASSWORD, TestServer};
use binnacle_orders::firms;
use binnacle_platform::ids::{FirmId, OperatorId};
use binnacle_platform::secret::{self, HashMemory};
use binnacle_platform::session::{self, Role};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use reqwest::Method;
use serde_json::{Value, json};
use std::sync::OnceLock;

/// A signed-in person.
#[derive(Clone)]
pub struct Person {
    url: String,
    http: reqwest::Client,
    /// Operator of the person, or of the admin who created them.
    pub operator: OperatorId,
    /// E-mail address, which is the name for sign-in.
    pub email: String,
    /// Session cookie.
    pub cookie: String,
}

/// Status, headers and body of a response.
#[derive(Debug)]
pub struct ApiResponse {
    /// HTTP status.
    pub status: u16,
    /// HTTP headers.
    pub headers: reqwest::header::HeaderMap,
    /// Body.
    pub text: String,
}

impl ApiResponse {
    /// Sends a request and reads its response.
    pub async fn send(request: reqwest::RequestBuilder) -> ApiResponse {
        let response = request.send().await.unwrap();
        ApiResponse {
            status: response.status().as_u16(),
            headers: response.headers().clone(),
            text: response.text().await.unwrap(),
        }
    }

    /// Parses the body.
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.text).unwrap_or_else(|_| panic!("not JSON: {self:?}"))
    }

    /// Returns the JSON of a successful response.
    pub fn good(&self) -> Value {
        assert!((200..300).contains(&self.status), "{self:?}");
        self.json()
    }

    /// Returns the last segment of a problem's type, after checking the problem document.
    pub fn problem(&self) -> String {
        let problem = self.json();
        assert_eq!(self.headers["content-type"], "application/problem+json");
        assert_eq!(problem["status"], self.status);
        assert!(problem["title"].is_string() && problem["detail"].is_string());
        let kind = problem["type"].as_str().unwrap();
        kind.rsplit('/').next().unwrap().to_owned()
    }
}

/// Returns the hash of [`PASSWORD`], computed once because hashing is slow.
pub fn password_hash() -> &'static str {
    static HASH: OnceLock<String> = OnceLock::new();
    HASH.get_or_init(|| secret::hash_password(PASSWORD, &mut HashMemory::default()).unwrap())
}

impl TestServer {
    /// Creates an operator with one admin, and signs the admin in.
    pub async fn admin(&self, name: &str) -> Person {
        Person::admin(self, name).await
    }
}

impl Person {
    pub(crate) async fn admin(server: &TestServer, name: &str) -> Person {
        let operator = create_operator(server, name).await;
        let email = format!("{name}@example.com");
        Person::create(server, Some(operator.into()), &email, Role::Admin).await;
        Person::sign_in(server, operator, &email).await
    }

    /// Creates a firm that works for this person's operator, and signs its adjuster in.
    pub async fn adjuster(&self, server: &TestServer, name: &str) -> (FirmId, Person) {
        let now = Time(server.app.clock.now());
        let mut tx = server.app.db.begin().await.unwrap();
        let firm = firms::create(&mut tx, name, now).await.unwrap();
        firms::engage(&mut tx, self.operator, firm, now)
            .await
            .unwrap();
        tx.commit().await.unwrap();
        let email = format!("{name}@adjusters.example");
        Person::create(server, Some(firm.into()), &email, Role::Adjuster).await;
        (firm, Person::sign_in(server, self.operator, &email).await)
    }

    /// Creates a platform admin, and signs them in.
    pub async fn platform_admin(&self, server: &TestServer) -> Person {
        let email = "root@example.com";
        Person::create(server, None, email, Role::PlatformAdmin).await;
        Person::sign_in(server, self.operator, email).await
    }

    /// Creates a viewer of the same operator, and signs them in.
    pub async fn viewer(&self, server: &TestServer) -> Person {
        let email = format!("viewer-{}", self.email);
        Person::create(server, Some(self.operator.into()), &email, Role::Viewer).await;
        Person::sign_in(server, self.operator, &email).await
    }

    /// Creates a person without signing in.
    pub async fn create(server: &TestServer, tenant: Option<Tenant>, email: &str, role: Role) {
        let now = Time(server.app.clock.now());
        let mut tx = server.app.db.begin().await.unwrap();
        session::create_user(&mut tx, tenant, email, email, role, password_hash(), now)
            .await
            .unwrap();
        tx.commit().await.unwrap();
    }

    /// Signs an existing person in.
    pub async fn sign_in(server: &TestServer, operator: OperatorId, email: &str) -> Person {
        let response = try_sign_in(server, email, PASSWORD).await;
        assert_eq!(response.status, 200, "{response:?}");
        let cookie = response.headers["set-cookie"].to_str().unwrap();
        Person {
            url: server.url.clone(),
            http: server.http.clone(),
            operator,
            email: email.to_owned(),
            cookie: cookie.split(';').next().unwrap().to_owned(),
        }
    }

    /// Returns the same person with a server that was restarted.
    pub fn reconnect(&self, server: &TestServer) -> Person {
        Person {
            url: server.url.clone(),
            ..self.clone()
        }
    }

    /// Builds a request as the dashboard makes it.
    pub fn request(&self, method: Method, path: &str) -> reqwest::RequestBuilder {
        self.http
            .request(method, format!("{}/api/v1{path}", self.url))
            .header("cookie", &self.cookie)
            .header("x-binnacle-request", "1")
    }

    /// Sends a GET request.
    pub async fn get(&self, path: &str) -> ApiResponse {
        ApiResponse::send(self.request(Method::GET, path)).await
    }

    /// Sends a POST request.
    pub async fn post(&self, path: &str, body: &Value) -> ApiResponse {
        ApiResponse::send(self.request(Method::POST, path).json(body)).await
    }

    /// Creates a vessel with one compass.
    pub async fn create_vessel(&self, name: &str) -> Value {
        self.post("/vessels", &json!({ "name": name })).await.good()
    }
}

/// Sends a sign-in request.
pub async fn try_sign_in(server: &TestServer, email: &str, password: &str) -> ApiResponse {
    let request = server
        .http
        .post(format!("{}/api/v1/session", server.url))
        .json(&json!({ "email": email, "password": password }));
    ApiResponse::send(request).await
}

async fn create_operator(server: &TestServer, name: &str) -> OperatorId {
    let now = Time(server.app.clock.now());
    let mut tx = server.app.db.begin().await.unwrap();
    let id = binnacle_fleet::operators::create(&mut tx, name, now)
        .await
        .unwrap();
    tx.commit().await.unwrap();
    id
}

/// Sends a PATCH request.
pub async fn patch(person: &Person, path: &str, body: &Value) -> ApiResponse {
    ApiResponse::send(person.request(Method::PATCH, path).json(body)).await
}
