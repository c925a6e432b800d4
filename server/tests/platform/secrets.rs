//! No secret in the log, not even at the most verbose level.

use crate::second_factor::app_code;
use binnacle_platform::clock::Clock;
use binnacle_server_testing::{CLIENT_SECRET, Provider, client};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;

/// The running program, with all its output.
pub(crate) struct Program {
    child: Child,
    pub(crate) url: String,
    log_output: JoinHandle<String>,
}

impl Program {
    pub(crate) fn start(folder: &Path, log: &str, more: &[&str]) -> Program {
        let mut child = command(folder)
            .args(["serve", "--listen", "127.0.0.1:0", "--webhooks-to-private"])
            .args(["--smtp-url", "smtp://relay:smtp-pass-word@localhost:9"])
            .args(["--mail-from", "alerts@binnacle.example"])
            .args(["--public-url", "http://127.0.0.1"])
            .args(more)
            .env("BINNACLE_LOG", log)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut errors = child.stderr.take().unwrap();
        let log_output = std::thread::spawn(move || {
            let mut all = Vec::new();
            errors.read_to_end(&mut all).unwrap();
            String::from_utf8_lossy(&all).into_owned()
        });
        let mut line = String::new();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        out.read_line(&mut line).unwrap();
        let url = line.trim().strip_prefix("listening on ").unwrap();
        Program {
            url: url.to_owned(),
            child,
            log_output,
        }
    }

    pub(crate) fn stop(mut self) -> String {
        let pid = rustix::process::Pid::from_child(&self.child);
        rustix::process::kill_process(pid, rustix::process::Signal::TERM).unwrap();
        self.child.wait().unwrap();
        self.log_output.join().unwrap()
    }
}

#[test]
fn a_mistyped_secret_setting_is_refused_without_being_printed() {
    let folder = tempfile::tempdir().unwrap();
    for (name, value) in [
        ("BINNACLE_SECRETS_KEY", "0123456789abcdefg"),
        ("BINNACLE_METRICS_TOKEN", "short-token"),
    ] {
        let mut serve = command(folder.path());
        let serve = serve.args(["serve", "--listen", "127.0.0.1:0"]);
        let refused = serve.env(name, value).output().unwrap();
        assert!(!refused.status.success(), "{name}");
        let said = String::from_utf8(refused.stderr).unwrap();
        assert!(said.contains(name), "{said}");
        assert!(!said.contains(value), "{said}");
    }
}

fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_binnacle-server"));
    command
        .current_dir(folder)
        .env("BINNACLE_DATABASE_URL", "sqlite://binnacle.db");
    command
}

fn admin(folder: &Path, arguments: &[&str]) -> Value {
    let output = command(folder).arg("admin").args(arguments).output();
    serde_json::from_slice(&output.unwrap().stdout).unwrap()
}

/// A client that records every secret it has seen.
struct RecordingClient {
    http: reqwest::Client,
    url: String,
    secrets: Vec<String>,
}

impl RecordingClient {
    /// Records the secrets of a response.
    fn record(&mut self, value: &Value) -> String {
        let secret = value.as_str().unwrap().to_owned();
        self.secrets.push(secret.clone());
        secret
    }

    /// Waits until another process has sent a delivery, or tried to.
    async fn wait_for_attempt(&self, key: &str, receiver: &str) {
        for _ in 0..5000 {
            let path = format!("{receiver}/deliveries");
            let (_, list) = self.send(key, "GET", &path, json!({})).await;
            if list["items"][0]["attempts"].as_i64().unwrap() > 0 {
                return;
            }
        }
        panic!("nothing was sent to {receiver}");
    }

    /// Signs in through the provider, and records cookies and secrets in addresses.
    async fn sign_in_through_provider(&mut self) {
        let there = self.follow("/api/v1/session/provider/start", "").await;
        let cookie = self.secrets.last().unwrap().clone();
        let back = self.http.get(&there).send().await.unwrap();
        let back = back.headers()["location"].to_str().unwrap().to_owned();
        let (_, path) = back.split_once("127.0.0.1").unwrap();
        let (_, state) = path.split_once("state=").unwrap();
        self.secrets.push(state.to_owned());
        let cookie = format!("binnacle_provider={cookie}");
        assert_eq!(self.follow(path, &cookie).await, "/");
    }

    /// Returns the redirect target, and records the value of the first cookie.
    async fn follow(&mut self, path: &str, cookie: &str) -> String {
        let url = format!("{}{path}", self.url);
        let request = self.http.get(url).header("cookie", cookie);
        let response = request.send().await.unwrap();
        let set = response.headers()["set-cookie"].to_str().unwrap();
        let (_, value) = set.split(';').next().unwrap().split_once('=').unwrap();
        self.secrets.push(value.to_owned());
        response.headers()["location"].to_str().unwrap().to_owned()
    }

    async fn send(&self, key: &str, method: &str, path: &str, body: Value) -> (String, Value) {
        let method = reqwest::Method::from_bytes(method.as_bytes()).unwrap();
        let url = format!("{}/api/v1{path}", self.url);
        let request = self.http.request(method, url).json(&body);
        let request = if key.contains('=') {
            request
                .header("cookie", key)
                .header("x-binnacle-request", "1")
        } else {
            request.bearer_auth(key)
        };
        let response = request.send().await.unwrap();
        let cookie = response.headers().get("set-cookie");
        let cookie = cookie.map_or("", |cookie| cookie.to_str().unwrap());
        let cookie = cookie.split(';').next().unwrap().to_owned();
        let bytes = response.bytes().await.unwrap();
        (cookie, serde_json::from_slice(&bytes).unwrap_or_default())
    }
}

/// Creates an operator and its first admin; returns what the command prints.
fn first_admin(folder: &Path) -> Value {
    let operator = admin(folder, &["create", "operator", "--name", "ada"]);
    let operator = operator["operator_id"].as_str().unwrap();
    let user = ["create", "user", "--operator", operator, "--role", "admin"];
    let who = ["--email", "ada@example.com", "--name", "Ada"];
    let user: Vec<&str> = user.into_iter().chain(who).collect();
    admin(folder, &user)
}

#[tokio::test]
async fn no_secret_is_in_the_most_verbose_log() {
    let _ = rustls::crypto::ring::default_provider().install_default();
    let provider = Provider::start().await;
    let folder = tempfile::tempdir().unwrap();
    let made = first_admin(folder.path());
    let program = Program::start(folder.path(), "trace", &provider.settings());
    let mut api = RecordingClient {
        http: client(),
        url: program.url.clone(),
        secrets: vec!["smtp-pass-word".to_owned(), "a-wrong-guess".to_owned()],
    };
    let password = api.record(&made["password"]);
    let email = "ada@example.com";
    let wrong = json!({ "email": email, "password": "a-wrong-guess" });
    api.send("", "POST", "/session", wrong).await;
    let right = json!({ "email": email, "password": password });
    let (cookie, _) = api.send("", "POST", "/session", right).await;
    let session = cookie.split_once('=').unwrap().1.to_owned();
    api.secrets.push(session);

    let lasting = Clock::System.now().micros() / 1_000_000 + 3600;
    provider.set_claims(json!({ "exp": lasting }));
    api.sign_in_through_provider().await;
    api.secrets.extend(provider.secrets());
    api.secrets.push(CLIENT_SECRET.to_owned());

    let token = json!({ "name": "ERP", "scope": "write" });
    let (_, token) = api.send(&cookie, "POST", "/tokens", token).await;
    let token = api.record(&token["token"]);
    let vessel = json!({ "name": "Nao" });
    let (_, vessel) = api.send(&token, "POST", "/vessels", vessel).await;
    let agents = format!("/vessels/{}/agents", vessel["id"].as_str().unwrap());
    let (_, code) = api.send(&token, "POST", &agents, json!({})).await;
    let code = api.record(&code["code"]);
    let enrol = json!({ "code": code, "agent_version": "1" });
    let (_, agent) = api.send("", "POST", "/agents/enrol", enrol).await;
    let agent = api.record(&agent["token"]);
    let (_, next) = api.send(&agent, "POST", "/agents/token", json!({})).await;
    let next = api.record(&next["token"]);
    let put = json!({ "token": next });
    api.send(&agent, "PUT", "/agents/token", put).await;
    api.send(&next, "POST", "/streams", json!({})).await;

    let hook = format!("{}/none?key=in-the-address", api.url);
    api.secrets.push("in-the-address".to_owned());
    let hook = json!({ "url": hook, "kinds": ["alert.raised"] });
    let (_, hook) = api.send(&cookie, "POST", "/webhooks", hook).await;
    api.record(&hook["secret"]);
    let hook = format!("/webhooks/{}", hook["id"].as_str().unwrap());
    let test = format!("{hook}/test");
    api.send(&cookie, "POST", &test, json!({})).await;
    api.wait_for_attempt(&cookie, &hook).await;
    let mail = json!({ "address": "office@example.com" });
    let (_, mail) = api.send(&cookie, "POST", "/mail-recipients", mail).await;
    let mail = format!("/mail-recipients/{}", mail["id"].as_str().unwrap());
    let test = format!("{mail}/test");
    api.send(&cookie, "POST", &test, json!({})).await;
    api.wait_for_attempt(&cookie, &mail).await;
    let feed = json!({ "name": "Fleet" });
    let (_, feed) = api.send(&cookie, "POST", "/calendar-feeds", feed).await;
    let feed = feed["url"]
        .as_str()
        .unwrap()
        .split_once("?token=")
        .unwrap()
        .1;
    let feed = api.record(&json!(feed));
    let read = format!("/calendar.ics?token={feed}");
    api.send("", "GET", &read, json!({})).await;

    let proof = json!({ "password": password });
    let (_, begun) = api.send(&cookie, "POST", "/me/second-factor", proof).await;
    let secret = api.record(&begun["secret"]);
    let unix_s = Clock::System.now().micros() / 1_000_000;
    let code = json!({ "code": app_code(&secret, unix_s) });
    let confirm = "/me/second-factor/confirm";
    let (_, codes) = api.send(&cookie, "POST", confirm, code).await;
    for code in codes["recovery_codes"].as_array().unwrap() {
        api.record(code);
    }
    let code = codes["recovery_codes"][0].clone();
    let right = json!({ "email": email, "password": password, "code": code });
    let (cookie, _) = api.send("", "POST", "/session", right).await;
    let session = cookie.split_once('=').unwrap().1.to_owned();
    api.secrets.push(session);
    let colleague = json!({ "email": "bob@example.com", "name": "Bob", "role": "viewer" });
    let (_, bob) = api.send(&cookie, "POST", "/users", colleague).await;
    let code = api.record(&bob["invitation"]["code"]);
    api.secrets.push("a lantern astern at midnight".to_owned());
    let accept = json!({ "code": code, "password": "a lantern astern at midnight" });
    api.send("", "POST", "/invitations/accept", accept).await;
    let changed = json!({ "current": password, "new": "seven gulls over the quay" });
    api.secrets.push("seven gulls over the quay".to_owned());
    api.send(&cookie, "PUT", "/me/password", changed).await;

    let log = program.stop();
    assert!(log.contains("TRACE") && log.contains("sqlx"), "{log}");
    for secret in &api.secrets {
        assert!(!secret.is_empty());
        let line = log.lines().find(|line| line.contains(secret.as_str()));
        assert_eq!(line, None, "{secret:?} is in the log");
    }
}
