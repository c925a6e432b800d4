//! The real Signal K server as a process, with instruments that send it NMEA 0183 over TCP, and
//! programs that send it deltas.

use super::bridge::LEAD_DEG;
use futures_util::stream::SplitSink;
use futures_util::{SinkExt, StreamExt};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use tempfile::TempDir;
use tokio::io::AsyncWriteExt;
use tokio::net::{TcpListener, TcpStream};
use tokio::process::{Child, Command};
use tokio::sync::watch;
use tokio::time::{Instant, interval, timeout};
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::{WebSocketStream, client_async};

/// Timeout; only a failing test reaches it.
const PATIENCE: Duration = Duration::from_mins(1);
/// Time within which a busy machine starts the server, and attempts at it.
const START: Duration = Duration::from_mins(2);
const ATTEMPTS: u32 = 3;
/// Interval of the compass and the gyro.
const INTERVAL: Duration = Duration::from_millis(100);
/// Reading of the compass.
pub(crate) const COMPASS_DEG: f64 = 90.0;
/// Name of the server's input.
const INPUT: &str = "bridge";
/// User of the server, and the bcrypt hash of the password `admin`.
const ADMIN: &str = "admin";
const ADMIN_HASH: &str = "$2a$04$xqt5MzXhIBq.wcB/RMkI.u2YIk4y3ASTq/sJqrLgDuZpg0LCbANbW";

/// Instruments that send.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Instruments {
    pub(crate) compass: bool,
    pub(crate) gyro: bool,
}

/// A running server with its instruments, killed when dropped.
pub(crate) struct SignalKServer {
    pub(crate) address: SocketAddr,
    pub(crate) instruments: watch::Sender<Instruments>,
    /// Time of the compass's last sentence.
    pub(crate) compass_sent: watch::Receiver<Instant>,
    client: reqwest::Client,
    admin: Option<String>,
    process: Child,
    /// Settings and log of the server.
    folder: Arc<TempDir>,
}

impl SignalKServer {
    /// Starts a server without security.
    pub(crate) async fn start(instruments: Instruments) -> SignalKServer {
        SignalKServer::start_with(instruments, &json!(null)).await
    }

    /// Starts a server that gives nothing to strangers.
    pub(crate) async fn start_secure(instruments: Instruments) -> SignalKServer {
        let security = json!({
            "allow_readonly": false, "expiration": "1d", "allowNewUserRegistration": false,
            "allowDeviceAccessRequests": true, "secretKey": "a secret of this test", "acls": [],
            "users": [{"username": ADMIN, "type": "admin", "password": ADMIN_HASH}],
            "devices": [],
        });
        let mut server = SignalKServer::start_with(instruments, &security).await;
        let login = json!({"username": ADMIN, "password": "admin"});
        let address = server.url("/signalk/v1/auth/login");
        let response = server.client.post(address).json(&login).send().await;
        let session: Value = response.unwrap().json().await.unwrap();
        server.admin = Some(session["token"].as_str().unwrap().to_owned());
        server
    }

    async fn start_with(instruments: Instruments, security: &Value) -> SignalKServer {
        rustls::crypto::ring::default_provider()
            .install_default()
            .ok();
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let bridge = listener.local_addr().unwrap();
        let (instruments, sending) = watch::channel(instruments);
        let (sent, compass_sent) = watch::channel(Instant::now());
        tokio::spawn(send_sentences(listener, sending, sent));

        let folder = Arc::new(TempDir::new().unwrap());
        if !security.is_null() {
            let path = folder.path().join("security.json");
            std::fs::write(path, security.to_string()).unwrap();
        }
        // The server takes no port 0, and one that was free a moment ago may be taken by now.
        for _ in 0..ATTEMPTS {
            let (address, process) = spawn(folder.path(), bridge, !security.is_null()).await;
            let mut server = SignalKServer {
                address,
                instruments: instruments.clone(),
                compass_sent: compass_sent.clone(),
                client: reqwest::Client::new(),
                admin: None,
                process,
                folder: folder.clone(),
            };
            if server.is_up().await {
                return server;
            }
        }
        let log = std::fs::read_to_string(folder.path().join("server.log"));
        panic!("the Signal K server does not start:\n{}", log.unwrap());
    }

    /// Waits until the server responds; not where it has ended, or found its port taken: then it
    /// goes on without.
    async fn is_up(&mut self) -> bool {
        let url = self.url("/signalk");
        let log = self.folder.path().join("server.log");
        let mut ticks = interval(Duration::from_millis(50));
        let up = timeout(START, async {
            loop {
                ticks.tick().await;
                let log = std::fs::read_to_string(&log).unwrap();
                if self.process.try_wait().unwrap().is_some() || log.contains("EADDRINUSE") {
                    return false;
                }
                if self.client.get(&url).send().await.is_ok() {
                    return true;
                }
            }
        });
        up.await.unwrap_or(false)
    }

    /// Returns the agent's input and its roles for this server.
    pub(crate) fn input(&self) -> String {
        format!(
            "[inputs.server]\nsignalk = \"ws://{}/signalk/v1/stream?subscribe=none\"",
            self.address
        )
    }

    fn url(&self, path: &str) -> String {
        format!("http://{}{path}", self.address)
    }

    /// Polls until there is a result.
    pub(crate) async fn when<T>(
        &self,
        what: &str,
        ask: impl AsyncFn(&SignalKServer) -> Option<T>,
    ) -> T {
        let mut ticks = interval(Duration::from_millis(50));
        let found = timeout(PATIENCE, async {
            loop {
                ticks.tick().await;
                if let Some(found) = ask(self).await {
                    return found;
                }
            }
        });
        found
            .await
            .unwrap_or_else(|_| panic!("not in time: {what}"))
    }

    async fn get(&self, path: &str) -> Value {
        let mut request = self.client.get(self.url(path));
        if let Some(token) = &self.admin {
            request = request.bearer_auth(token);
        }
        let response = request.send().await.unwrap();
        response.json().await.unwrap_or_default()
    }

    /// Returns the value that a source gave a path of `navigation` last.
    pub(crate) async fn value(&self, path: &str, source: &str) -> Option<Value> {
        let path = format!("/signalk/v1/api/vessels/self/navigation/{path}");
        let found = self.get(&path).await;
        if found["$source"] == source {
            return found.get("value").cloned();
        }
        found["values"][source].get("value").cloned()
    }

    /// Accepts the one access request that waits, and returns the permission that it asks for.
    pub(crate) async fn accept_request(&self) -> String {
        let request = self
            .when("an access request", async |server| {
                let requests = server.get("/skServer/security/access/requests").await;
                requests.as_array().and_then(|all| all.first().cloned())
            })
            .await;
        let identifier = request["accessIdentifier"].as_str().unwrap();
        let path = format!("/skServer/security/access/requests/{identifier}/approved");
        let permissions = &request["permissions"];
        let decision = json!({
            "expiration": "NEVER", "permissions": permissions, "config": {},
        });
        let accepted = self.client.put(self.url(&path)).json(&decision);
        let accepted = accepted.bearer_auth(self.admin.as_ref().unwrap());
        let response = accepted.send().await.unwrap();
        assert!(response.status().is_success(), "{response:?}");
        permissions.as_str().unwrap().to_owned()
    }

    /// Connects a program that sends deltas.
    pub(crate) async fn program(&self) -> DeltaSender {
        let stream = TcpStream::connect(self.address).await.unwrap();
        let url = format!("ws://{}/signalk/v1/stream?subscribe=none", self.address);
        let (sender, mut received) = client_async(url, stream).await.unwrap().0.split();
        // The server ends those who do not read.
        tokio::spawn(async move { while let Some(Ok(_)) = received.next().await {} });
        DeltaSender(sender)
    }
}

/// Program that sends deltas to the server.
pub(crate) struct DeltaSender(SplitSink<WebSocketStream<TcpStream>, Message>);

impl DeltaSender {
    /// Sends a direction of `navigation` in degrees.
    pub(crate) async fn send(&mut self, source: &str, path: &str, deg: f64) {
        let value = json!({"path": format!("navigation.{path}"), "value": deg.to_radians()});
        let update = json!({"$source": source, "values": [value]});
        let delta = json!({"context": "vessels.self", "updates": [update]});
        self.0.send(Message::text(delta.to_string())).await.unwrap();
    }
}

/// Starts the server's process at a port that is free.
async fn spawn(folder: &Path, bridge: SocketAddr, is_secure: bool) -> (SocketAddr, Child) {
    let free = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = free.local_addr().unwrap();
    drop(free);
    let mut settings = settings(address.port(), bridge);
    if is_secure {
        settings["security"] = json!({"strategy": "./tokensecurity"});
    }
    std::fs::write(folder.join("settings.json"), settings.to_string()).unwrap();
    let log = std::fs::File::create(folder.join("server.log")).unwrap();
    let process = Command::new(program())
        .arg("-c")
        .arg(folder)
        .stdin(Stdio::null())
        .stdout(log.try_clone().unwrap())
        .stderr(log)
        .kill_on_drop(true)
        .spawn()
        .unwrap();
    (address, process)
}

/// Returns the program that `scripts/signalk-server` installs.
fn program() -> PathBuf {
    let program = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.tools/signalk-server/run");
    assert!(
        program.exists(),
        "there is no Signal K server to test with: run scripts/signalk-server"
    );
    program
}

fn settings(port: u16, bridge: SocketAddr) -> Value {
    let off = [
        "appstore", "webapps", "plugins", "logfiles", "nmea-tcp", "tcp",
    ];
    let interfaces: serde_json::Map<String, Value> = off
        .iter()
        .map(|name| ((*name).to_owned(), json!(false)))
        .collect();
    let options = json!({
        "logging": false, "type": "NMEA0183",
        "subOptions": {"type": "tcp", "host": "127.0.0.1", "port": bridge.port().to_string()},
    });
    json!({
        "port": port, "ssl": false, "mdns": false, "interfaces": interfaces,
        "pipedProviders": [{
            "id": INPUT, "enabled": true,
            "pipeElements": [{"type": "providers/simple", "options": options}],
        }],
    })
}

fn sentence(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

/// Sends to the server for as long as it listens: position and time each second, compass and gyro
/// ten times a second while they are on.
async fn send_sentences(
    listener: TcpListener,
    instruments: watch::Receiver<Instruments>,
    sent: watch::Sender<Instant>,
) {
    loop {
        let (mut stream, _) = listener.accept().await.unwrap();
        let mut ticks = interval(INTERVAL);
        for count in 0_u64.. {
            ticks.tick().await;
            let Instruments { compass, gyro } = *instruments.borrow();
            let mut text = String::new();
            if count % 10 == 0 {
                text += &fix();
            }
            if gyro {
                text += &sentence(&format!("HEHDT,{:.1},T", COMPASS_DEG + LEAD_DEG));
            }
            if compass {
                text += &sentence(&format!("HCHDG,{COMPASS_DEG:.1},,,1.0,W"));
            }
            if stream.write_all(text.as_bytes()).await.is_err() {
                break;
            }
            if compass {
                sent.send_replace(Instant::now());
            }
        }
    }
}

/// Returns the sentence of a receiver now.
#[allow(
    clippy::disallowed_methods,
    reason = "the server gives readings the real time, and the receiver must agree"
)]
pub(crate) fn fix() -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
    let micros = i64::try_from(now.as_micros()).unwrap();
    let (date, time) = binnacle_nmea::time::from_unix_micros(micros).unwrap();
    let data = binnacle_nmea::Data::Rmc(Some(binnacle_nmea::sentence::Rmc {
        time: Some(time),
        date: Some(date),
        position: Some(binnacle_nmea::sentence::Position {
            lat_deg_north: 43.3,
            lon_deg_east: -3.0,
        }),
        sog_kn: Some(8.0),
        cog_deg_true: Some(COMPASS_DEG + LEAD_DEG),
        ..binnacle_nmea::sentence::Rmc::default()
    }));
    let mut text = Vec::new();
    let talker = *b"GP";
    binnacle_nmea::write(&binnacle_nmea::Sentence { talker, data }, &mut text);
    String::from_utf8(text).unwrap()
}
