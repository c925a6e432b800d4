//! Peers that do not go on, and those that do, on real connections.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

use axum::Router;
use axum::body::{Body, Bytes};
use axum::routing::{get, post};
use binnacle_listener::{Limits, Stream, plain, serve};
use futures_util::stream;
use std::convert::Infallible;
use std::future::pending;
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Notify, mpsc};
use tokio::task::JoinHandle;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;

/// Time after which a test gives up.
const PATIENCE: Duration = Duration::from_secs(30);
/// Limit that a test waits for.
const SHORT: Duration = Duration::from_millis(400);

/// Bytes with which a client begins HTTP/2 (RFC 9113, section 3.4), and an empty SETTINGS.
const PREFACE: &[u8] = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\x04\0\0\0\0\0";
/// PING of HTTP/2 (RFC 9113, section 6.7).
const PING: &[u8] = b"\0\0\x08\x06\0\0\0\0\0binnacle";

fn generous() -> Limits {
    let long = Duration::from_mins(10);
    Limits {
        connections: 256,
        connections_per_network: None,
        handshake: long,
        head: long,
        idle: long,
        stall: long,
        drain: PATIENCE,
    }
}

/// A running listener. Its routes: `/` responds, `/endless` never ends, `/upload` reads all,
/// `/events` and `/slow` wait for `go`.
struct Served {
    address: SocketAddr,
    go: Arc<Notify>,
    /// Receives one each time a handler or a body of `/endless` or `/upload` is dropped.
    ended: mpsc::UnboundedReceiver<()>,
    /// Receives one when `/slow` is called.
    called: mpsc::UnboundedReceiver<()>,
    stopping: CancellationToken,
    serving: JoinHandle<usize>,
}

/// Tells when it is dropped.
struct Ending(mpsc::UnboundedSender<()>);

impl Drop for Ending {
    fn drop(&mut self) {
        self.0.send(()).ok();
    }
}

async fn start(limits: Limits) -> Served {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let go = Arc::new(Notify::new());
    let (end, ended) = mpsc::unbounded_channel();
    let (call, called) = mpsc::unbounded_channel();
    let uploaded = end.clone();
    let (event, slow) = (go.clone(), go.clone());
    let endless = move || {
        let ending = Ending(end.clone());
        let chunks = stream::repeat_with(move || {
            let _held = &ending;
            Ok::<_, Infallible>(Bytes::from(vec![0; 100_000]))
        });
        async move { Body::from_stream(chunks) }
    };
    let events = move || {
        let next = stream::unfold(event.clone(), async |event| {
            event.notified().await;
            Some((Ok::<_, Infallible>("data: 1\n\n"), event))
        });
        async move { Body::from_stream(next) }
    };
    let upload = move |body: Bytes| async move { body.len().to_string() };
    let begun = move |request: axum::extract::Request, next: axum::middleware::Next| {
        let ending = Ending(uploaded.clone());
        async move {
            let response = next.run(request).await;
            drop(ending);
            response
        }
    };
    let waiting = move || {
        let slow = slow.clone();
        call.send(()).ok();
        async move {
            slow.notified().await;
            "done"
        }
    };
    let upload = post(upload).layer(axum::middleware::from_fn(begun));
    let router = Router::new()
        .route("/", get(async || "here"))
        .route("/endless", get(endless))
        .route("/events", get(events))
        .route("/slow", get(waiting))
        .route("/upload", upload);
    let stopping = CancellationToken::new();
    let serving = tokio::spawn(serve(listener, limits, plain, router, stopping.clone()));
    Served {
        address,
        go,
        ended,
        called,
        stopping,
        serving,
    }
}

async fn connect(address: SocketAddr, bytes: &[u8]) -> TcpStream {
    let mut peer = TcpStream::connect(address).await.unwrap();
    peer.write_all(bytes).await.unwrap();
    peer
}

/// Waits until the listener closes a connection, and returns what it sent.
async fn closed(peer: &mut TcpStream) -> Vec<u8> {
    let mut received = Vec::new();
    let read = timeout(PATIENCE, peer.read_to_end(&mut received)).await;
    // A reset is an end too.
    drop(read.expect("the connection is closed in time"));
    received
}

fn client() -> reqwest::ClientBuilder {
    // A client wants a provider also for plain HTTP; another test may have been first.
    let _ = rustls::crypto::ring::default_provider().install_default();
    reqwest::Client::builder().no_proxy().timeout(PATIENCE)
}

async fn ask(address: SocketAddr) -> reqwest::Result<String> {
    let request = client().build()?.get(format!("http://{address}/"));
    request.send().await?.text().await
}

#[tokio::test]
async fn half_a_head_ends_while_others_are_served() {
    let limits = Limits {
        head: SHORT,
        ..generous()
    };
    let served = start(limits).await;
    let mut halves = Vec::new();
    for head in [&b"GET / HTTP/1.1\r\nHo"[..], b"", b"PRI * HTTP/2.0\r\n"] {
        for _ in 0..20 {
            halves.push(connect(served.address, head).await);
        }
    }
    assert_eq!(ask(served.address).await.unwrap(), "here");
    for half in &mut halves {
        assert!(!closed(half).await.starts_with(b"HTTP/1.1 200"));
    }
    assert_eq!(ask(served.address).await.unwrap(), "here");
}

#[tokio::test]
async fn http2_without_a_request_ends_however_often_it_pings() {
    let limits = Limits {
        head: SHORT,
        ..generous()
    };
    let served = start(limits).await;
    let (mut read, mut write) = connect(served.address, PREFACE).await.into_split();
    let pings = async {
        let mut responses = [0; 1024];
        // Each response to a ping is followed by the next ping.
        while write.write_all(PING).await.is_ok() {
            if !matches!(read.read(&mut responses).await, Ok(1..)) {
                break;
            }
        }
    };
    timeout(PATIENCE, pings).await.unwrap();
}

#[tokio::test]
async fn a_handshake_that_never_ends_is_given_up() {
    let limits = Limits {
        handshake: SHORT,
        ..generous()
    };
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let never = |stream: Stream| async {
        let _stream = stream;
        pending::<io::Result<Stream>>().await
    };
    tokio::spawn(serve(
        listener,
        limits,
        never,
        Router::new(),
        CancellationToken::new(),
    ));
    closed(&mut connect(address, b"").await).await;
}

#[tokio::test]
async fn an_address_has_its_number_of_connections_and_gets_them_back() {
    let limits = Limits {
        connections_per_network: Some(3),
        ..generous()
    };
    let served = start(limits).await;
    let mut held = Vec::new();
    for _ in 0..3 {
        held.push(connect(served.address, b"GET").await);
    }
    assert!(ask(served.address).await.is_err());
    let other = client().local_address(IpAddr::from([127, 0, 0, 2]));
    let request = other
        .build()
        .unwrap()
        .get(format!("http://{}/", served.address));
    assert_eq!(request.send().await.unwrap().text().await.unwrap(), "here");
    held.pop();
    // The listener learns of the end by itself.
    let again = async { while ask(served.address).await.is_err() {} };
    timeout(PATIENCE, again).await.unwrap();
}

#[tokio::test]
async fn a_full_listener_serves_those_who_wait_once_others_end() {
    let limits = Limits {
        connections: 2,
        head: SHORT,
        ..generous()
    };
    let served = start(limits).await;
    let _first = connect(served.address, b"GET").await;
    let _second = connect(served.address, b"GET").await;
    assert_eq!(ask(served.address).await.unwrap(), "here");
}

#[tokio::test]
async fn who_reads_nothing_is_dropped() {
    let limits = Limits {
        stall: SHORT,
        ..generous()
    };
    let mut served = start(limits).await;
    let request = b"GET /endless HTTP/1.1\r\nhost: a\r\n\r\n";
    let _unread = connect(served.address, request).await;
    let end = timeout(PATIENCE, served.ended.recv()).await;
    assert_eq!(end.unwrap(), Some(()));
}

#[tokio::test]
async fn who_gives_http2_no_window_is_dropped() {
    let limits = Limits {
        stall: SHORT,
        ..generous()
    };
    let mut served = start(limits).await;
    let client = client()
        .http2_prior_knowledge()
        .http2_initial_stream_window_size(1000);
    let url = format!("http://{}/endless", served.address);
    let unread = client.build().unwrap().get(url).send().await.unwrap();
    let end = timeout(PATIENCE, served.ended.recv()).await;
    assert_eq!(end.unwrap(), Some(()));
    assert_eq!(unread.version(), reqwest::Version::HTTP_2);
}

#[tokio::test]
async fn an_upload_that_stops_half_way_is_dropped_and_a_whole_one_is_not() {
    let limits = Limits {
        stall: SHORT,
        ..generous()
    };
    let mut served = start(limits).await;
    let head =
        b"POST /upload HTTP/1.1\r\nhost: a\r\nconnection: close\r\ncontent-length: 9\r\n\r\n";
    let mut half = connect(served.address, head).await;
    half.write_all(b"1").await.unwrap();
    closed(&mut half).await;
    let end = timeout(PATIENCE, served.ended.recv()).await;
    assert_eq!(end.unwrap(), Some(()));
    let mut whole = connect(served.address, head).await;
    whole.write_all(b"123456789").await.unwrap();
    assert!(closed(&mut whole).await.ends_with(b"\r\n\r\n9"));
}

#[tokio::test]
async fn an_idle_connection_is_closed_and_a_stream_without_events_is_not() {
    let limits = Limits {
        idle: SHORT,
        stall: SHORT,
        ..generous()
    };
    let served = start(limits).await;
    let events = b"GET /events HTTP/1.1\r\nhost: a\r\n\r\n";
    let mut events = connect(served.address, events).await;
    let mut head = [0; 12];
    events.read_exact(&mut head).await.unwrap();
    for _ in 0..3 {
        let request = b"GET / HTTP/1.1\r\nhost: a\r\n\r\n";
        let mut idle = connect(served.address, request).await;
        assert!(closed(&mut idle).await.ends_with(b"here"));
    }
    served.go.notify_one();
    let mut received = Vec::new();
    while !received.ends_with(b"data: 1\n\n\r\n") {
        let read = timeout(PATIENCE, events.read_buf(&mut received)).await;
        assert!(read.unwrap().unwrap() > 0, "{received:?}");
    }
}

#[tokio::test]
async fn a_long_response_arrives_whole() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let long: Vec<u8> = (0..1_000_003_u32).map(|byte| byte as u8).collect();
    let body = Bytes::from(long.clone());
    let router = Router::new().route("/", get(async move || body.clone()));
    let stopping = CancellationToken::new();
    tokio::spawn(serve(listener, generous(), plain, router, stopping));
    for http2 in [false, true] {
        let client = if http2 {
            client().http2_prior_knowledge()
        } else {
            client()
        };
        let response = client.build().unwrap().get(format!("http://{address}/"));
        let response = response.send().await.unwrap();
        assert_eq!(response.content_length(), Some(long.len() as u64));
        assert!(response.bytes().await.unwrap() == long, "http2: {http2}");
    }
}

#[tokio::test]
async fn a_listener_that_stops_finishes_what_it_has_begun() {
    let mut served = start(generous()).await;
    let request = b"GET /slow HTTP/1.1\r\nhost: a\r\n\r\n";
    let mut slow = connect(served.address, request).await;
    let mut idle = connect(served.address, b"").await;
    served.called.recv().await.unwrap();
    served.stopping.cancel();
    closed(&mut idle).await;
    assert!(TcpStream::connect(served.address).await.is_err());
    assert!(!served.serving.is_finished());
    served.go.notify_one();
    assert!(closed(&mut slow).await.ends_with(b"done"));
    let cut_off = timeout(PATIENCE, served.serving).await;
    assert_eq!(cut_off.unwrap().unwrap(), 0);
}

#[tokio::test]
async fn what_does_not_finish_is_cut_off_and_counted() {
    let limits = Limits {
        drain: SHORT,
        ..generous()
    };
    let mut served = start(limits).await;
    let request = b"GET /slow HTTP/1.1\r\nhost: a\r\n\r\n";
    let mut slow = connect(served.address, request).await;
    served.called.recv().await.unwrap();
    served.stopping.cancel();
    let cut_off = timeout(PATIENCE, served.serving).await;
    assert_eq!(cut_off.unwrap().unwrap(), 1);
    assert!(closed(&mut slow).await.is_empty());
}
