//! The first run of a server, invitations of companies' users, and forgotten passwords.

use crate::second_factor::set_up;
use binnacle_fleet::operators;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::execute;
use binnacle_platform::ids::UserId;
use binnacle_platform::time::Time;
use binnacle_server_testing::{
    ApiResponse, Engine, PASSWORD, Relay, TestServer, on_both, try_sign_in,
};
use serde_json::{Value, json};
use std::time::Duration;

on_both!(
    an_empty_server_is_set_up_with_a_printed_code,
    a_set_up_code_expires_and_only_an_empty_server_prints_one,
    an_operators_own_firm_is_seen_by_nobody_else_until_it_is_connected,
    a_platform_admin_invites_a_companys_first_user,
    an_unknown_address_gets_the_same_response_as_a_known_one,
    nobody_invites_an_admin_beside_one_who_signs_in_by_a_provider,
    a_new_password_is_judged_only_for_who_may_set_it,
);

/// Longest wait for a letter to a relay in this process.
const PATIENCE: Duration = Duration::from_secs(20);

async fn print_code(server: &TestServer) -> Option<String> {
    let now = Time(server.app.clock.now());
    let request = RequestContext::of_command(&server.app.db, "admin first-run", now);
    let made = operators::make_first_run_code(&server.app.db, &request, now).await;
    made.unwrap().map(|(code, _)| code)
}

async fn send(server: &TestServer, path: &str, body: &Value) -> ApiResponse {
    let url = format!("{}/api/v1{path}", server.url);
    ApiResponse::send(server.http.post(url).json(body)).await
}

async fn is_open(server: &TestServer) -> Value {
    let url = format!("{}/api/v1/first-run", server.url);
    ApiResponse::send(server.http.get(url)).await.good()["open"].clone()
}

fn first(code: &str) -> Value {
    json!({ "code": code, "operator_name": "Armada del Sur", "name": "Ada Lovelace",
            "email": "Ada@Example.com", "password": "seven gulls over the quay" })
}

async fn an_empty_server_is_set_up_with_a_printed_code(server: TestServer) {
    assert_eq!(is_open(&server).await, true);
    let guessed = send(&server, "/first-run", &first("AAAA-AAAA-AAAA-AAAA")).await;
    assert_eq!(guessed.problem(), "not-found");
    let code = print_code(&server).await.unwrap();
    let mut weak = first(&code);
    weak["password"] = json!("armada del sur");
    assert_eq!(
        send(&server, "/first-run", &weak).await.problem(),
        "invalid"
    );
    let made = send(&server, "/first-run", &first(&code.to_lowercase())).await;
    assert_eq!(made.good()["email"], "ada@example.com");
    let signed_in = try_sign_in(&server, "ada@example.com", "seven gulls over the quay").await;
    let me = signed_in.good();
    assert_eq!(
        (&me["role"], &me["operator_name"]),
        (&json!("admin"), &json!("Armada del Sur"))
    );
    assert_eq!(is_open(&server).await, false);
    let again = send(&server, "/first-run", &first(&code)).await;
    assert_eq!(again.problem(), "wrong-state");
    server.finish().await;
}

async fn a_set_up_code_expires_and_only_an_empty_server_prints_one(server: TestServer) {
    let code = print_code(&server).await.unwrap();
    server.advance(86_400.0);
    let late = send(&server, "/first-run", &first(&code)).await;
    assert_eq!(late.problem(), "gone");
    server.admin("ada").await;
    assert_eq!(print_code(&server).await, None);
    server.finish().await;
}

async fn an_operators_own_firm_is_seen_by_nobody_else_until_it_is_connected(server: TestServer) {
    let (ada, eve) = (server.admin("ada").await, server.admin("eve").await);
    let root = ada.platform_admin(&server).await;
    let firm = ada
        .post("/firms", &json!({ "name": "Nervión" }))
        .await
        .good();
    assert_eq!(firm["is_own"], true);
    let id = firm["id"].as_str().unwrap();
    let users = format!("/firms/{id}/users");
    let rosa = json!({ "name": "Rosa Sáez", "email": "rosa@nervion.example" });
    assert_eq!(
        eve.get(&format!("/firms/{id}")).await.problem(),
        "not-found"
    );
    // The response is that for a firm that there is not.
    assert_eq!(eve.post(&users, &rosa).await.problem(), "forbidden");
    let nowhere = format!("/firms/{}/users", eve.operator);
    assert_eq!(eve.post(&nowhere, &rosa).await.problem(), "forbidden");
    let invited = ada.post(&users, &rosa).await.good();
    let accepted = json!({ "code": invited["code"], "password": "seven gulls over the quay" });
    send(&server, "/invitations/accept", &accepted).await.good();
    let signed_in = try_sign_in(&server, "rosa@nervion.example", "seven gulls over the quay").await;
    assert_eq!(signed_in.good()["role"], "adjuster");
    let engage = format!("/operators/{}/firms/{id}", eve.operator);
    let request = root.request(reqwest::Method::PUT, &engage);
    assert_eq!(ApiResponse::send(request).await.status, 204);
    assert_eq!(
        eve.get(&format!("/firms/{id}")).await.good()["is_own"],
        false
    );
    // What others work with too is the platform's business.
    let other = json!({ "name": "M. Etxeberria", "email": "m@nervion.example" });
    assert_eq!(ada.post(&users, &other).await.problem(), "forbidden");
    root.post(&users, &other).await.good();
    server.finish().await;
}

async fn a_platform_admin_invites_a_companys_first_user(server: TestServer) {
    let ada = server.admin("ada").await;
    let root = ada.platform_admin(&server).await;
    let made = root
        .post("/operators", &json!({ "name": "Elcano" }))
        .await
        .good();
    let users = format!("/operators/{}/users", made["id"].as_str().unwrap());
    let juan = json!({ "name": "Juan", "email": "juan@elcano.example" });
    assert_eq!(ada.post(&users, &juan).await.problem(), "forbidden");
    let invited = root.post(&users, &juan).await.good();
    // The relay of the tests' settings does not respond.
    assert_eq!(invited["mailed"], false);
    let twice = root.post(&users, &juan).await;
    assert_eq!(twice.problem(), "wrong-state");
    let accepted = json!({ "code": invited["code"], "password": "seven gulls over the quay" });
    send(&server, "/invitations/accept", &accepted).await.good();
    let signed_in = try_sign_in(&server, "juan@elcano.example", "seven gulls over the quay").await;
    assert_eq!(signed_in.good()["operator_name"], "Elcano");
    // From then on those who run the server let nobody into the fleet.
    let other = json!({ "name": "Root", "email": "root@server.example" });
    let refused = root.post(&users, &other).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(refused.text.contains("has an admin"), "{refused:?}");
    server.finish().await;
}

async fn nobody_invites_an_admin_beside_one_who_signs_in_by_a_provider(server: TestServer) {
    let ada = server.admin("ada").await;
    let root = ada.platform_admin(&server).await;
    let id = ada.get("/me").await.good()["user_id"].clone();
    let id = UserId(id.as_str().unwrap().parse().unwrap());
    let mut tx = server.app.db.begin().await.unwrap();
    execute!(
        &mut tx,
        "UPDATE users SET password_hash = '' WHERE id = $1",
        id
    )
    .unwrap();
    execute!(
        &mut tx,
        "INSERT INTO identities (issuer, subject, user_id, created_at)
         VALUES ('https://login.example', 'ada', $1, 0)",
        id
    )
    .unwrap();
    tx.commit().await.unwrap();
    let users = format!("/operators/{}/users", ada.operator);
    let other = json!({ "name": "Root", "email": "root@server.example" });
    assert_eq!(root.post(&users, &other).await.problem(), "wrong-state");
    server.finish().await;
}

async fn a_new_password_is_judged_only_for_who_may_set_it(server: TestServer) {
    let ada = server.admin("ada").await;
    let weak = json!({ "current": "a guess", "new": "password1234" });
    let change = ada.request(reqwest::Method::PUT, "/me/password");
    let refused = ApiResponse::send(change.json(&weak)).await;
    assert_eq!(refused.problem(), "wrong-password");
    let weak = json!({ "code": "AAAA-AAAA-AAAA-AAAA", "password": "password1234" });
    let refused = send(&server, "/invitations/accept", &weak).await;
    assert_eq!(refused.problem(), "not-found");
    server.finish().await;
}

async fn an_unknown_address_gets_the_same_response_as_a_known_one(server: TestServer) {
    let ada = server.admin("ada").await;
    for email in [ada.email.as_str(), "nobody@example.com"] {
        let asked = send(&server, "/password-resets", &json!({ "email": email })).await;
        assert_eq!((asked.status, asked.text.as_str()), (202, ""));
    }
    // The password stays as it is until the code is used.
    assert_eq!(try_sign_in(&server, &ada.email, PASSWORD).await.status, 200);
    server.finish().await;
}

#[tokio::test]
async fn a_forgotten_password_is_set_with_a_mailed_code_and_an_invitation_is_mailed() {
    let relay = Relay::start().await;
    let smtp = format!("smtp://localhost:{}?tls=none", relay.port);
    let server = TestServer::start_with(Engine::Sqlite, &["--smtp-url", &smtp]).await;
    let (ada, bob) = (server.admin("ada").await, server.admin("bob").await);
    set_up(&server, &ada).await;
    let forgotten = json!({ "email": ada.email.to_uppercase() });
    for _ in 0..2 {
        let asked = send(&server, "/password-resets", &forgotten).await;
        assert_eq!(asked.status, 202);
    }
    wait_for_letters(&relay, 1).await;
    let code = mailed_code(&relay, &ada.email);
    let accepted = json!({ "code": code, "password": "seven gulls over the quay" });
    send(&server, "/invitations/accept", &accepted).await.good();
    let old = try_sign_in(&server, &ada.email, PASSWORD).await;
    assert_eq!(old.problem(), "wrong-password");
    // Whoever reads her mail has not her second factor.
    let new = try_sign_in(&server, &ada.email, "seven gulls over the quay").await;
    assert_eq!(new.problem(), "second-factor-needed");
    let grace = json!({ "email": "grace@example.com", "name": "Grace", "role": "viewer" });
    let invited = bob.post("/users", &grace).await.good();
    assert_eq!(invited["invitation"]["mailed"], true);
    let code = mailed_code(&relay, "grace@example.com");
    assert_eq!(invited["invitation"]["code"], code.as_str());
    // Asked for twice within minutes, sent once.
    assert_eq!(relay.letters().len(), 2);
    // A stranger who asks for her does not end her invitation, and the audit log says so.
    let forgotten = json!({ "email": "grace@example.com" });
    assert_eq!(
        send(&server, "/password-resets", &forgotten).await.status,
        202
    );
    wait_for_letters(&relay, 3).await;
    let lines = bob.get("/audit?route=/api/v1/password-resets").await.good();
    assert_eq!(lines["items"].as_array().unwrap().len(), 1, "{lines}");
    assert_eq!(lines["items"][0]["actor_kind"], "unidentified");
    let accepted = json!({ "code": code, "password": "seven gulls over the quay" });
    send(&server, "/invitations/accept", &accepted).await.good();
    server.finish().await;
}

#[tokio::test]
async fn an_address_gets_a_few_letters_a_day_and_a_network_asks_for_so_many() {
    let relay = Relay::start().await;
    let smtp = format!("smtp://localhost:{}?tls=none", relay.port);
    let server = TestServer::start_with(Engine::Sqlite, &["--smtp-url", &smtp]).await;
    let ada = server.admin("ada").await;
    let ask = async |email: &str| {
        let forgotten = json!({ "email": email });
        send(&server, "/password-resets", &forgotten).await
    };
    for letters in 1..=5 {
        assert_eq!(ask(&ada.email).await.status, 202);
        wait_for_letters(&relay, letters).await;
        server.advance(300.0);
    }
    for number in 6..=50 {
        // The permits of letters that were not sent are free again soon.
        let asked = tokio::time::timeout(PATIENCE, async {
            while ask(&ada.email).await.status != 202 {
                tokio::task::yield_now().await;
            }
        });
        asked.await.unwrap_or_else(|_| panic!("{number}"));
        server.advance(300.0);
    }
    let refused = ask("nobody@example.com").await;
    assert_eq!(refused.problem(), "throttled");
    assert_eq!(relay.letters().len(), 5);
    server.finish().await;
}

async fn wait_for_letters(relay: &Relay, count: usize) {
    let waited = tokio::time::timeout(PATIENCE, async {
        while relay.letters().len() < count {
            tokio::task::yield_now().await;
        }
    });
    waited.await.unwrap();
}

/// Returns the code in the letter to an address.
fn mailed_code(relay: &Relay, address: &str) -> String {
    let letters = relay.letters();
    let mut to = letters
        .iter()
        .filter(|letter| letter.to.iter().any(|to| to.contains(address)));
    let text = &to.next().unwrap().text;
    let (_, code) = text
        .split_once("https://binnacle.example/invitation#")
        .unwrap();
    code.lines().next().unwrap().trim().to_owned()
}
