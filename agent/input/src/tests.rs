//! Inputs over real sockets, a real pseudo-terminal and real files.

use super::{InputStats, Port, PortEvent, SharedEnds, spawn};
use crate::config::InputConfig;
use binnacle_observation::{Observation, Reading, is_recorded_time};
use futures_util::{SinkExt, StreamExt};
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::AsyncWriteExt;
use tokio::net::{TcpListener, UdpSocket};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tokio_serial::SerialPort;
use tokio_tungstenite::accept_async;
use tokio_tungstenite::tungstenite::Message;
use tokio_util::sync::CancellationToken;

const HEADING: &[u8] = b"$GPHDT,274.07,T*03\r\n";
const SPOILT: &[u8] = b"$GPHDT,274.08,T*03\r\n";
/// Timeout; only a failing test reaches it.
const PATIENCE: Duration = Duration::from_secs(30);

struct Input {
    observations: mpsc::Receiver<Vec<Observation>>,
    stats: Arc<InputStats>,
    shutdown: CancellationToken,
    task: JoinHandle<()>,
}

impl Input {
    fn start(toml: &str, room: usize) -> Input {
        Input::of(
            toml::from_str(toml).expect("the configuration is sound"),
            room,
        )
    }

    fn of(config: InputConfig, room: usize) -> Input {
        Input::shared(config, SharedEnds::default(), room)
    }

    fn shared(config: InputConfig, ends: SharedEnds, room: usize) -> Input {
        let (tx, observations) = mpsc::channel(room);
        let stats = Arc::new(InputStats::default());
        let shutdown = CancellationToken::new();
        let task = spawn(
            "bridge".into(),
            config,
            ends,
            tx,
            stats.clone(),
            shutdown.clone(),
        );
        Input {
            observations,
            stats,
            shutdown,
            task,
        }
    }

    async fn next(&mut self) -> Vec<Observation> {
        tokio::time::timeout(PATIENCE, self.observations.recv())
            .await
            .expect("observations come in time")
            .expect("the input goes on")
    }

    /// Waits for a count to be reached.
    async fn until(&self, reached: impl Fn(&super::InputStatus) -> bool) {
        let reach = async {
            while !reached(&self.stats.status()) {
                tokio::task::yield_now().await;
            }
        };
        let in_time = tokio::time::timeout(PATIENCE, reach).await;
        assert!(in_time.is_ok(), "{:?}", self.stats.status());
    }

    async fn stop(self) {
        self.shutdown.cancel();
        self.task.await.expect("the task ends without a panic");
        assert!(!self.stats.status().connected);
    }
}

fn is_heading(seen: &Observation) -> bool {
    matches!(seen.reading, Reading::True(heading) if (heading.degrees() - 274.07).abs() < 1e-9)
}

#[tokio::test]
async fn a_connection_that_breaks_off_is_made_again() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let mut input = Input::start(&format!("tcp = \"{address}\""), 8);
    for _ in 0..3 {
        let (mut bridge, _) = listener.accept().await.unwrap();
        // The last sentence is cut off: it must not run into the next connection.
        bridge.write_all(HEADING).await.unwrap();
        bridge.write_all(b"$GPHDT,27").await.unwrap();
        assert!(input.next().await.iter().all(is_heading));
    }
    input.until(|status| status.reconnects == 2).await;
    let status = input.stats.status();
    assert_eq!(status.sentences["HDT"], 3);
    assert!(status.rejected.is_empty(), "{status:?}");
    assert!(status.last_heard_s_ago.is_some());
    input.stop().await;
}

#[tokio::test]
async fn a_bridge_that_is_not_there_yet_is_waited_for() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    drop(listener);
    let mut input = Input::start(&format!("tcp = \"{address}\""), 8);
    input.until(|status| status.problem.is_some()).await;
    let listener = TcpListener::bind(address).await.unwrap();
    let (mut bridge, _) = listener.accept().await.unwrap();
    bridge.write_all(HEADING).await.unwrap();
    assert_eq!(input.next().await.len(), 1);
    assert_eq!(input.stats.status().problem, None);
    input.stop().await;
}

#[tokio::test]
async fn a_sender_over_tcp_waits_and_nothing_is_lost() {
    const COUNT: usize = 1_000_000;
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let mut input = Input::start(&format!("tcp = \"{address}\""), 1);
    let (mut bridge, _) = listener.accept().await.unwrap();
    let sender = tokio::spawn(async move {
        let stream = HEADING.repeat(COUNT);
        bridge.write_all(&stream).await.unwrap();
    });
    // One chunk fills the channel; far more than the sockets hold is to come.
    input.until(|status| status.observations > 0).await;
    assert!(!sender.is_finished());
    let mut taken = 0;
    while taken < COUNT {
        taken += input.next().await.len();
    }
    assert_eq!(taken, COUNT);
    assert_eq!(input.stats.status().dropped, 0);
    sender.await.unwrap();
    input.stop().await;
}

#[tokio::test]
async fn noise_and_an_endless_line_are_counted_and_what_follows_is_read() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let mut input = Input::start(&format!("tcp = \"{address}\""), 8);
    let (mut bridge, _) = listener.accept().await.unwrap();
    bridge.write_all(&[0xff, 0, 7, b'\n']).await.unwrap();
    bridge.write_all(&vec![b'x'; 10_000_000]).await.unwrap();
    bridge.write_all(b"\n").await.unwrap();
    bridge.write_all(SPOILT).await.unwrap();
    bridge.write_all(HEADING).await.unwrap();
    assert!(input.next().await.iter().all(is_heading));
    let rejected = input.stats.status().rejected;
    assert_eq!(rejected["too long"], 1);
    assert_eq!(rejected["not a sentence"], 1);
    assert_eq!(rejected["wrong checksum"], 1);
    input.stop().await;
}

/// Returns a port that was free a moment ago.
async fn free_port() -> u16 {
    let socket = UdpSocket::bind("0.0.0.0:0").await.unwrap();
    socket.local_addr().unwrap().port()
}

#[tokio::test]
async fn datagrams_are_read_and_those_without_room_are_counted() {
    let port = free_port().await;
    let mut input = Input::start(&format!("udp = \"127.0.0.1:{port}\""), 1);
    input.until(|status| status.connected).await;
    let bridge = UdpSocket::bind("127.0.0.1:0").await.unwrap();
    bridge.connect(("127.0.0.1", port)).await.unwrap();
    bridge.send(HEADING.trim_ascii_end()).await.unwrap();
    assert!(input.next().await.iter().all(is_heading));
    // One delivery fits; one more at least cannot.
    while input.stats.status().dropped == 0 {
        bridge.send(HEADING).await.unwrap();
        tokio::task::yield_now().await;
    }
    let stats = input.stats.clone();
    input.stop().await;
    let status = stats.status();
    assert_eq!(
        status.observations + status.dropped,
        status.sentences["HDT"]
    );
}

#[tokio::test]
async fn a_group_of_the_ship_network_is_joined() {
    let port = free_port().await;
    let mut input = Input::start(
        &format!("multicast = {{ group = \"239.192.0.4:{port}\", interface = \"127.0.0.1\" }}"),
        8,
    );
    input.until(|status| status.connected).await;
    let bridge = socket2::Socket::new(socket2::Domain::IPV4, socket2::Type::DGRAM, None).unwrap();
    bridge.set_multicast_if_v4(&Ipv4Addr::LOCALHOST).unwrap();
    bridge.set_multicast_loop_v4(true).unwrap();
    let group = std::net::SocketAddrV4::new(Ipv4Addr::new(239, 192, 0, 4), port).into();
    let tagged = [b"UdPbC\0\\s:HE0001,n:1*0C\\", HEADING].concat();
    bridge.send_to(&tagged, &group).unwrap();
    bridge.send_to(HEADING, &group).unwrap();
    assert!(input.next().await.iter().all(is_heading));
    input
        .until(|status| status.rejected.get("not a datagram of sentences") == Some(&1))
        .await;
    input.stop().await;
}

#[tokio::test]
async fn a_serial_port_is_read() {
    let (mut instrument, port) = tokio_serial::SerialStream::pair().unwrap();
    let path = port.name().expect("a pseudo-terminal has a name");
    let mut input = Input::start(&format!("serial = {{ path = \"{path}\" }}"), 8);
    input.until(|status| status.connected).await;
    instrument.write_all(HEADING).await.unwrap();
    assert!(input.next().await.iter().all(is_heading));
    input.stop().await;
}

#[tokio::test]
async fn a_serial_port_that_is_not_there_is_tried_again() {
    let input = Input::start("serial = { path = \"/dev/binnacle-none\" }", 8);
    input.until(|status| status.problem.is_some()).await;
    assert!(!input.task.is_finished());
    input.stop().await;
}

#[tokio::test]
async fn a_file_is_read_to_its_end_once() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.nmea");
    let mut text = b"2026-01-02T12:00:00Z ".to_vec();
    text.extend_from_slice(HEADING);
    text.extend_from_slice(HEADING.trim_ascii_end());
    std::fs::write(&path, &text).unwrap();
    let mut input = Input::start(&format!("file = {path:?}"), 8);
    let mut seen = Vec::new();
    while let Some(more) = input.observations.recv().await {
        seen.extend(more);
    }
    assert_eq!(seen.len(), 3);
    assert!(is_recorded_time(&seen[0]));
    assert!(seen[1..].iter().all(is_heading));
    input.stop().await;
}

#[tokio::test]
async fn a_signal_k_server_is_asked_and_followed_over_a_restart() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let url = format!("ws://{address}/signalk/v1/stream?subscribe=none");
    let mut input = Input::start(&format!("signalk = \"{url}\""), 8);
    for _ in 0..2 {
        let (stream, _) = listener.accept().await.unwrap();
        let mut server = accept_async(stream).await.unwrap();
        let asked = server.next().await.unwrap().unwrap().into_text().unwrap();
        assert!(asked.contains("\"navigation.headingCompass\""), "{asked}");
        for text in [
            r#"{"name":"server","version":"2.0.0","self":"vessels.urn:mrn:imo:mmsi:230099999"}"#,
            "not a delta",
            r#"{"context":"vessels.urn:mrn:imo:mmsi:230099999","updates":[{"$source":"n2k.204",
                "timestamp":"2026-01-02T12:00:00Z","values":[
                {"path":"navigation.headingCompass","value":1.0},
                {"path":"navigation.rateOfTurn","value":0.0}]}]}"#,
        ] {
            server.send(Message::text(text)).await.unwrap();
        }
        let seen = input.next().await;
        assert_eq!(seen.len(), 2);
        assert_eq!(&seen[0].source.sentence, b"HDG");
        server.close(None).await.unwrap();
    }
    let status = input.stats.status();
    assert_eq!(status.rejected["bad delta"], 2);
    assert_eq!(status.sentences["navigation.headingCompass"], 2);
    input.stop().await;
}

/// Request that a Signal K server with security gets: its first line, and whether it has the token.
async fn peek_request(stream: &tokio::net::TcpStream) -> (String, bool) {
    let mut head = vec![0; 4096];
    loop {
        let count = stream.peek(&mut head).await.unwrap();
        let text = String::from_utf8_lossy(&head[..count]).into_owned();
        if text.contains("\r\n\r\n") {
            let has_token = text
                .to_lowercase()
                .contains("authorization: bearer the-token");
            return (text.lines().next().unwrap().to_owned(), has_token);
        }
    }
}

#[tokio::test]
async fn a_signal_k_server_with_security_is_asked_for_access_once() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let url = format!("signalk = \"ws://{address}/signalk/v1/stream\"");
    let mut config: InputConfig = toml::from_str(&url).unwrap();
    config.resolve(folder.path(), folder.path(), "sk");
    let mut input = Input::of(config.clone(), 8);
    let (mut requests, mut strangers) = (Vec::new(), Vec::new());
    let admitted = loop {
        let (stream, _) = listener.accept().await.unwrap();
        let (line, has_token) = peek_request(&stream).await;
        requests.push(line.clone());
        let (status, body) = match line.as_str() {
            line if line.starts_with("POST") => {
                let body = r#"{"state":"PENDING","requestId":"7","href":"/signalk/v1/requests/7"}"#;
                ("202 Accepted", body)
            }
            line if line.starts_with("GET /signalk/v1/requests/7") => {
                let body = r#"{"state":"COMPLETED","statusCode":200,
                    "accessRequest":{"permission":"APPROVED","token":"the-token"}}"#;
                ("200 OK", body)
            }
            _ if has_token => break accept_async(stream).await.unwrap(),
            line if line.starts_with("GET /signalk/v1/stream") => {
                // As the real server does: it greets strangers, and sends them nothing.
                let mut server = accept_async(stream).await.unwrap();
                let greeting = r#"{"name":"server","version":"2.0.0"}"#;
                server.send(Message::text(greeting)).await.unwrap();
                strangers.push(server);
                continue;
            }
            _ => ("401 Unauthorized", ""),
        };
        respond(stream, status, body).await;
    };
    let posts = requests.iter().filter(|line| line.starts_with("POST"));
    assert_eq!(posts.count(), 1, "{requests:?}");
    input.until(|status| status.connected).await;
    input.stop().await;
    drop(admitted);
    // The token serves after a restart.
    input = Input::of(config, 8);
    let (stream, _) = listener.accept().await.unwrap();
    assert!(peek_request(&stream).await.1);
    input.stop().await;
}

/// Serves one request of a Signal K server with security.
async fn respond(mut stream: tokio::net::TcpStream, status: &str, body: &str) {
    let response = format!(
        "HTTP/1.1 {status}\r\ncontent-type: application/json\r\ncontent-length: {}\r\n\
         connection: close\r\n\r\n{body}",
        body.len()
    );
    stream.write_all(response.as_bytes()).await.unwrap();
    // What the client still sends is read, so that the response is not lost with a reset.
    tokio::io::copy(&mut stream, &mut tokio::io::sink())
        .await
        .ok();
}

#[tokio::test]
async fn a_server_is_read_while_the_right_to_send_to_it_is_asked_for() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let registration = r#"{"client_id":"00000000-0000-0000-0000-000000000007","token":"old"}"#;
    std::fs::write(folder.path().join("signalk-sk.json"), registration).unwrap();
    let url = format!("signalk = \"ws://{address}/signalk/v1/stream\"");
    let mut config: InputConfig = toml::from_str(&url).unwrap();
    config.resolve(folder.path(), folder.path(), "sk");
    let (mut port, end) = Port::new();
    let ends = SharedEnds {
        deltas: Some(end),
        ..SharedEnds::default()
    };
    let mut input = Input::shared(config, ends, 8);
    let (stream, _) = listener.accept().await.unwrap();
    let mut server = accept_async(stream).await.unwrap();
    let (stream, _) = listener.accept().await.unwrap();
    assert!(peek_request(&stream).await.0.starts_with("POST"));
    let delta = r#"{"context":"vessels.self","updates":[{"$source":"n2k.204","values":[
        {"path":"navigation.headingCompass","value":1.0}]}]}"#;
    server.send(Message::text(delta)).await.unwrap();
    assert_eq!(&input.next().await[0].source.sentence, b"HDG");
    let body = r#"{"state":"PENDING","requestId":"7","href":"/signalk/v1/requests/7"}"#;
    respond(stream, "202 Accepted", body).await;
    let (stream, _) = listener.accept().await.unwrap();
    let body = r#"{"state":"COMPLETED","statusCode":200,
        "accessRequest":{"permission":"APPROVED","token":"the-token"}}"#;
    respond(stream, "200 OK", body).await;
    let (stream, _) = listener.accept().await.unwrap();
    assert!(peek_request(&stream).await.1);
    let mut server = accept_async(stream).await.unwrap();
    assert!(server.next().await.unwrap().unwrap().is_text());
    while port.events.recv().await != Some(PortEvent::Closed) {}
    assert_eq!(port.events.recv().await, Some(PortEvent::Opened));
    assert!(port.send("a delta".to_owned()));
    let sent = server.next().await.unwrap().unwrap();
    assert_eq!(sent.into_text().unwrap().as_str(), "a delta");
    input.stop().await;
}

#[tokio::test]
async fn a_signal_k_server_is_read_over_tls() {
    let certified = rcgen::generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sk.pem"), certified.cert.pem()).unwrap();
    let key = rustls::pki_types::PrivateKeyDer::try_from(certified.signing_key.serialize_der());
    let tls = rustls::ServerConfig::builder_with_provider(std::sync::Arc::new(
        rustls::crypto::ring::default_provider(),
    ))
    .with_safe_default_protocol_versions()
    .unwrap()
    .with_no_client_auth()
    .with_single_cert(vec![certified.cert.der().clone()], key.unwrap())
    .unwrap();
    let listener = TcpListener::bind("localhost:0").await.unwrap();
    let port = listener.local_addr().unwrap().port();
    let toml = format!(
        "signalk = {{ url = \"wss://localhost:{port}/signalk/v1/stream\", ca = \"sk.pem\" }}"
    );
    let mut config: InputConfig = toml::from_str(&toml).unwrap();
    config.resolve(folder.path(), folder.path(), "sk");
    rustls::crypto::ring::default_provider()
        .install_default()
        .ok();
    let mut input = Input::of(config, 8);
    let (stream, _) = listener.accept().await.unwrap();
    let acceptor = tokio_rustls::TlsAcceptor::from(Arc::new(tls));
    let mut server = accept_async(acceptor.accept(stream).await.unwrap())
        .await
        .unwrap();
    let text = r#"{"context":"vessels.self","updates":[{"$source":"n2k.204","values":[
        {"path":"navigation.headingCompass","value":1.0}]}]}"#;
    server.send(Message::text(text)).await.unwrap();
    assert_eq!(&input.next().await[0].source.sentence, b"HDG");
    input.stop().await;
}

#[tokio::test]
async fn an_input_ends_when_nobody_listens() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let input = Input::start(&format!("tcp = \"{address}\""), 1);
    let (mut bridge, _) = listener.accept().await.unwrap();
    drop(input.observations);
    bridge.write_all(HEADING).await.unwrap();
    tokio::time::timeout(PATIENCE, input.task)
        .await
        .expect("it ends in time")
        .unwrap();
}
