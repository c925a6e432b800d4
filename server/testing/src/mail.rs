//! Mail recipients, and delivery to a relay in this process.

use crate::person::Person;
use crate::relay::{Letter, Relay};
use crate::server::TestServer;
use binnacle_fleet::alerts;
use binnacle_planning::reports;
use binnacle_platform::config;
use binnacle_platform::mail::Mailer;
use binnacle_platform::outbox::{self, Sent};
use serde_json::{Value, json};
use std::process::Command;
use std::time::Duration;

/// Timeout that a relay in this process keeps easily, and that a test can wait for.
pub const PATIENCE: Duration = Duration::from_millis(1500);

/// Returns a mailer that sends to a relay in this process.
pub fn mailer(relay: &Relay) -> Mailer {
    let config = config::Mail {
        smtp_url: Some(format!("smtp://localhost:{}?tls=none", relay.port)),
        smtp_ca: None,
        mail_from: Some("Binnacle <alerts@binnacle.example>".to_owned()),
        public_url: Some("https://binnacle.example/".to_owned()),
    };
    let mailer = Mailer::new(&config, alerts::TOPIC_LIST).unwrap().unwrap();
    let mailer = mailer.with_list(reports::MAILING_LIST);
    mailer.with_patience(PATIENCE)
}

/// Adds a mail recipient for alerts from a severity on.
pub async fn add(person: &Person, address: &str, severity: &str) -> Value {
    let new = json!({ "address": address, "severity": severity });
    person.post("/mail-recipients", &new).await.good()
}

/// Returns a path below a mail recipient.
pub fn path(recipient: &Value, rest: &str) -> String {
    format!(
        "/mail-recipients/{}{rest}",
        recipient["id"].as_str().unwrap()
    )
}

/// Queues a test letter to a recipient.
pub async fn test(person: &Person, recipient: &Value) -> Value {
    person
        .post(&path(recipient, "/test"), &json!({}))
        .await
        .good()
}

/// Sends every letter that is due now.
pub async fn deliver(server: &TestServer, relay: &Relay) -> Vec<Sent> {
    let mailer = mailer(relay);
    let mut sent = Vec::new();
    while let Some(done) = outbox::step(&server.app, &mailer).await.unwrap() {
        sent.push(done);
    }
    sent
}

/// Parses a letter with Python's mail parser into headers by name and `text`.
pub fn read(letter: &Letter) -> Value {
    let program = "import email, email.policy, json, sys\n\
        m = email.message_from_bytes(sys.argv[1].encode(), policy=email.policy.default)\n\
        assert not m.defects, m.defects\n\
        read = {k.lower(): str(v) for k, v in m.items()}\n\
        assert len(read) == len(m.items()), m.items()\n\
        read['text'] = m.get_content()\n\
        print(json.dumps(read))";
    let done = Command::new("python3")
        .args(["-c", program, &letter.text])
        .output()
        .unwrap();
    let problem = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{problem}\n{}", letter.text);
    serde_json::from_slice(&done.stdout).unwrap()
}

/// Returns the subjects of all letters so far.
pub fn subjects(relay: &Relay) -> Vec<String> {
    let got = relay.letters();
    let subjects = got.iter().map(|letter| read(letter)["subject"].take());
    subjects
        .map(|subject| subject.as_str().unwrap().to_owned())
        .collect()
}
