//! A whole order by the documentation's example program for firms.

use binnacle_orders::evidence;
use binnacle_server_testing::offers::OfferParties;
use binnacle_server_testing::on_both;
use binnacle_server_testing::webhooks::{Receiver, deliver, make};
use binnacle_server_testing::work_orders::{Job, reading};
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use reqwest::Method;
use serde_json::{Value, json};
use std::path::Path;
use std::process::Stdio;
use tokio::io::AsyncWriteExt;
use tokio::process::Command;
use uuid::Uuid;

on_both!(
    the_example_client_completes_an_order,
    the_example_client_asks_for_the_compass_reading_before_the_first_step,
    the_example_client_negotiates_sends_messages_and_gets_events,
    a_firm_can_read_ship_data_only_while_the_order_is_open,
    a_key_needs_proof_of_possession_and_signs_until_revoked,
);

const CLIENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/firm_client.py");
const WHO: [&str; 4] = ["--adjuster", "M. Etxeberria", "--licence", "ES-CA-114"];

/// The example program, run as a firm runs it.
struct Client<'a> {
    folder: &'a Path,
    server: String,
    token: String,
}

impl<'a> Client<'a> {
    async fn with_token(server: &TestServer, person: &Person, folder: &'a Path) -> Client<'a> {
        let token = json!({ "name": "office", "scope": "write" });
        let made = person.post("/tokens", &token).await.good();
        Client {
            folder,
            server: server.url.clone(),
            token: made["token"].as_str().unwrap().to_owned(),
        }
    }

    async fn run(&self, arguments: &[&str], input: &[u8]) -> (Option<i32>, String) {
        let mut child = Command::new("python3")
            .arg(CLIENT)
            .args(arguments)
            .current_dir(self.folder)
            .env("BINNACLE_SERVER", &self.server)
            .env("BINNACLE_TOKEN", &self.token)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stdin = child.stdin.take().unwrap();
        stdin.write_all(input).await.unwrap();
        drop(stdin);
        let done = child.wait_with_output().await.unwrap();
        let output = [done.stdout, done.stderr].concat();
        (done.status.code(), String::from_utf8(output).unwrap())
    }

    async fn good(&self, arguments: &[&str]) -> String {
        let (code, output) = self.run(arguments, b"").await;
        assert_eq!(code, Some(0), "{arguments:?}: {output}");
        output
    }
}

async fn the_example_client_asks_for_the_compass_reading_before_the_first_step(server: TestServer) {
    let (job, rosa) = offered(&server).await;
    let folder = tempfile::tempdir().unwrap();
    let client = Client::with_token(&server, &rosa, folder.path()).await;
    let order = job.order.as_str();
    client.good(&[&["accept", order], &WHO[..]].concat()).await;
    client.good(&["on-board", order]).await;
    let mut silent = reading();
    silent.as_object_mut().unwrap().remove("compass_deg");
    std::fs::write(folder.path().join("reading.json"), silent.to_string()).unwrap();
    let adjust = ["adjust", order, "--reading", "reading.json"];
    let (code, output) = client.run(&adjust, b"").await;
    assert_ne!(code, Some(0), "nobody answered: {output}");
    assert!(
        output.contains("the compass reads, before the step"),
        "{output}"
    );
    let adjusted = client.good(&["adjust", order, "--as-foretold"]).await;
    assert!(adjusted.contains("adjusting"), "{adjusted}");
    assert_eq!(job.view_order().await["next_step"], json!(null));
    server.finish().await;
}

async fn openssl(folder: &Path, arguments: &[&str]) -> Vec<u8> {
    let mut command = Command::new("openssl");
    let done = command
        .args(arguments)
        .current_dir(folder)
        .output()
        .await
        .unwrap();
    assert!(done.status.success(), "{done:?}");
    done.stdout
}

/// Offers an order to a firm of its own; returns the firm's adjuster.
pub(crate) async fn offered(server: &TestServer) -> (Job, Person) {
    let job = Job::begin(server).await;
    let (firm, rosa) = job.person.adjuster(server, "rosa").await;
    let offer = json!({ "firms": [firm] });
    job.post("/offer", &offer).await.good();
    (job, rosa)
}

async fn the_example_client_completes_an_order(server: TestServer) {
    let (job, rosa) = offered(&server).await;
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let client = Client::with_token(&server, &rosa, folder).await;
    let (receiver, url) = Receiver::start().await;
    let webhook = make(&rosa, &url, &["order.completed"]).await;
    let order = job.order.as_str();

    assert!(
        client
            .good(&["orders"])
            .await
            .contains("offered, answer by")
    );
    let (code, output) = client.run(&["on-board", order], b"").await;
    assert_eq!(code, Some(2));
    assert!(output.contains("wrong-state"), "{output}");
    let accepted = client.good(&[&["accept", order], &WHO[..]].concat()).await;
    assert!(accepted.contains("accepted"), "{accepted}");
    client.good(&["on-board", order]).await;
    std::fs::write(folder.join("reading.json"), reading().to_string()).unwrap();
    let adjust = [
        "adjust",
        order,
        "--reading",
        "reading.json",
        "--as-foretold",
    ];
    let adjusted = client.good(&adjust).await;
    assert!(adjusted.contains("adjusting"), "{adjusted}");
    let completed = client
        .good(&[&["complete", order], &WHO[..]].concat())
        .await;
    assert!(completed.contains("adjusted"), "{completed}");

    let key = ["genpkey", "-algorithm", "ED25519", "-out", "firm.pem"];
    openssl(folder, &key).await;
    let unknown = client.good(&["sign", order, "--key", "firm.pem"]).await;
    assert!(unknown.contains("unknown key"), "{unknown}");
    let register = ["register-key", "--key", "firm.pem", "--name", "Office"];
    client.good(&register).await;
    let signed = client.good(&["sign", order, "--key", "firm.pem"]).await;
    assert!(signed.contains("signed with Office"), "{signed}");

    client
        .good(&["evidence", order, "--out", "evidence.zip"])
        .await;
    let theirs = std::fs::read(folder.join("evidence.zip")).unwrap();
    let theirs = evidence::verify(&theirs, None);
    assert!(theirs.problems.is_empty(), "{theirs:?}");
    let facts = theirs.facts.join("\n");
    for fact in [
        "the server signed it: rosa had registered it as \"Office\"",
        "the server signed it: no firm had registered it",
        // The list of the firms that get the offer.
        "entries 3 are withheld: their content cannot be checked",
    ] {
        assert!(facts.contains(fact), "{fact}: {facts}");
    }
    let ours = evidence::verify(&job.evidence().await, None);
    assert!(ours.problems.is_empty(), "{ours:?}");
    assert!(!ours.facts.join("\n").contains("withheld"), "{ours:?}");
    let seen = job.view_order().await;
    assert_eq!(seen["completion"]["firm"], "rosa");
    assert_eq!(seen["signatures"][1]["key"]["firm_name"], "rosa");

    deliver(&server).await;
    let (header, body) = receiver.received().pop().unwrap();
    let now_s = server.app.clock.now().micros() / 1_000_000;
    let (secret, now_s) = (webhook["secret"].as_str().unwrap(), now_s.to_string());
    let check = [
        "check-webhook",
        "--secret",
        secret,
        "--header",
        &header,
        "--now",
        &now_s,
    ];
    let (code, output) = client.run(&check, body.as_bytes()).await;
    assert_eq!((code, output.trim()), (Some(0), "from Binnacle"));
    let forged = body.replace("adjusted", "verified");
    assert_eq!(client.run(&check, forged.as_bytes()).await.0, Some(1));
    server.finish().await;
}

async fn the_example_client_negotiates_sends_messages_and_gets_events(server: TestServer) {
    let parties = OfferParties::planned(&server, 1).await;
    let (firm, rosa) = &parties.firms[0];
    let terms = json!({ "fee_eur": 1800, "working_days": ["Sun"] });
    let path = format!("/firms/{firm}/terms");
    let put = parties.ada.request(Method::PUT, &path).json(&terms);
    ApiResponse::send(put).await.good();
    parties
        .post(&parties.ada, "/offer", &parties.offer())
        .await
        .good();
    let folder = tempfile::tempdir().unwrap();
    let client = Client::with_token(&server, rosa, folder.path()).await;
    let order = parties.order.as_str();
    let offered = client.good(&["order", order]).await;
    assert!(offered.contains("offered at 1800.00 euros"), "{offered}");
    let (code, output) = client.run(&["propose", order], b"").await;
    assert_eq!(code, Some(2), "{output}");
    let fee = ["propose", order, "--fee", "2100", "--text", "Two teams."];
    assert!(client.good(&fee).await.contains("proposed"));
    client
        .good(&["say", order, "--text", "Is there a crane?"])
        .await;
    let yes = json!({ "text": "Done." });
    parties.post(&parties.ada, "/messages", &yes).await;
    let read = client.good(&["messages", order]).await;
    assert!(read.contains("Is there a crane?"), "{read}");
    assert!(read.contains("Done."), "{read}");
    parties
        .post(&parties.ada, "/accept", &json!({}))
        .await
        .good();
    let agreed = client.good(&["order", order]).await;
    assert!(agreed.contains("agreed at 2100.00 euros"), "{agreed}");
    // All entries since the start: offer, proposal, both messages, agreement.
    let none = Uuid::nil().to_string();
    let events = client
        .good(&["events", "--last", &none, "--count", "5"])
        .await;
    let of_order = format!("work_order  order {order}");
    assert_eq!(events.matches(&of_order).count(), 5, "{events}");
    server.finish().await;
}

async fn a_firm_can_read_ship_data_only_while_the_order_is_open(server: TestServer) {
    let (job, rosa) = offered(&server).await;
    let (_, other) = job.person.adjuster(&server, "other").await;
    let paths = ["/model", "/binnacle"].map(|rest| job.path(rest));
    let vessel = [
        job.ship.path("/model"),
        job.ship
            .path(&format!("/compasses/{}/binnacle", job.compass)),
    ];
    for (path, vessel) in paths.iter().zip(&vessel) {
        let theirs = rosa.get(path).await.good();
        assert_eq!(theirs, job.person.get(vessel).await.good());
        assert_eq!(other.get(path).await.problem(), "not-found");
    }
    let post = |rest: &str, body: Value| {
        let request = rosa.request(Method::POST, &job.path(rest)).json(&body);
        ApiResponse::send(request)
    };
    let early = post("/berth-reading", reading()).await;
    assert_eq!(early.problem(), "wrong-state");
    post("/accept", json!({})).await.good();
    let early = post("/berth-reading", reading()).await;
    assert_eq!(early.problem(), "wrong-state");
    post("/on-board", json!({})).await.good();
    post("/berth-reading", reading()).await.good();
    assert!(rosa.get(&job.path("/plan")).await.good()["plans"].is_array());
    let planned = post("/plan", json!({})).await.good();
    assert!(planned["plan"].is_object());
    job.post("/cancel", &json!({ "text": "sold" })).await.good();
    for path in &paths {
        assert_eq!(rosa.get(path).await.problem(), "not-found", "{path}");
    }
    assert_eq!(rosa.get(&job.path("/plan")).await.problem(), "wrong-state");
    let order = rosa.get(&job.path("")).await.good();
    assert_eq!(
        (&order["state"], &order["plan"]),
        (&json!("cancelled"), &Value::Null)
    );
    assert!(job.view_order().await["plan"].is_object());
    server.finish().await;
}

async fn a_key_needs_proof_of_possession_and_signs_until_revoked(server: TestServer) {
    let ada = server.admin("ada").await;
    let (firm, rosa) = ada.adjuster(&server, "rosa").await;
    let (others, other) = ada.adjuster(&server, "other").await;
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    openssl(
        folder,
        &["genpkey", "-algorithm", "ED25519", "-out", "firm.pem"],
    )
    .await;
    let key = openssl(
        folder,
        &["pkey", "-in", "firm.pem", "-pubout", "-outform", "DER"],
    )
    .await;
    let hex = |bytes: &[u8]| {
        let digits = |text: String, byte: &u8| text + &format!("{byte:02x}");
        bytes.iter().fold(String::new(), digits)
    };
    let public_key = hex(&key[key.len() - 32..]);
    let proof = async |text: String| {
        std::fs::write(folder.join("text"), text).unwrap();
        let sign = [
            "pkeyutl", "-sign", "-rawin", "-inkey", "firm.pem", "-in", "text",
        ];
        hex(&openssl(folder, &sign).await)
    };
    let new = |public_key: &str, proof: &str| json!({ "name": "Office", "public_key": public_key, "proof": proof });
    let mine = proof(format!("binnacle firm key {firm}")).await;
    let path = format!("/firms/{firm}/keys");
    let theirs = format!("/firms/{others}/keys");
    // Another firm cannot register the key.
    let stolen = other.post(&theirs, &new(&public_key, &mine)).await;
    assert_eq!(stolen.problem(), "invalid");
    for bad in [
        new("00", &mine),
        new(&public_key, "00"),
        new(&"0".repeat(64), &mine),
        // A key of small order: its signature fits every text.
        new(
            &format!("01{}", "00".repeat(31)),
            &format!("01{}", "00".repeat(63)),
        ),
    ] {
        assert_eq!(rosa.post(&path, &bad).await.problem(), "invalid");
    }
    let made = rosa.post(&path, &new(&public_key, &mine)).await;
    assert_eq!(made.status, 201, "{made:?}");
    let repeated = rosa.post(&path, &new(&public_key, &mine)).await;
    assert_eq!(repeated.problem(), "wrong-state");
    for who in [&ada, &other] {
        let foreign = who.post(&path, &new(&public_key, &mine)).await;
        assert_eq!(foreign.problem(), "not-found");
    }
    assert_eq!(other.get(&path).await.problem(), "not-found");
    let seen = ada.get(&path).await.good();
    assert_eq!(seen["items"][0]["public_key"], public_key.as_str());
    let id = made.good()["id"].clone();
    let revoke = format!("{path}/{}", id.as_str().unwrap());
    let foreign = ApiResponse::send(other.request(Method::DELETE, &revoke)).await;
    assert_eq!(foreign.problem(), "not-found");
    assert_eq!(
        ApiResponse::send(rosa.request(Method::DELETE, &revoke))
            .await
            .status,
        204
    );
    assert_eq!(
        ApiResponse::send(rosa.request(Method::DELETE, &revoke))
            .await
            .status,
        404
    );
    let seen = rosa.get(&path).await.good();
    assert!(seen["items"][0]["revoked_at"].is_string(), "{seen}");
    assert_eq!(rosa.post(&path, &new(&public_key, &mine)).await.status, 201);
    server.finish().await;
}
