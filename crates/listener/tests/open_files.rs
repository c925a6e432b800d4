//! A process that has run out of files. Alone here: the limit is the whole process's.

use axum::Router;
use axum::routing::get;
use binnacle_listener::{Limits, plain, serve};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::fs::File;
use std::io::{self, Write};
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::mpsc;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;

const PATIENCE: Duration = Duration::from_secs(30);

/// Log whose lines a test waits for.
struct Log(mpsc::UnboundedSender<String>);

impl Write for Log {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        self.0.send(String::from_utf8_lossy(line).into_owned()).ok();
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[tokio::test]
async fn without_files_to_open_the_listener_waits_and_goes_on() {
    let (line, mut lines) = mpsc::unbounded_channel();
    tracing_subscriber::fmt()
        .with_writer(move || Log(line.clone()))
        .init();
    let limit = Duration::from_mins(1);
    let limits = Limits {
        connections: 16,
        connections_per_network: None,
        handshake: limit,
        head: limit,
        idle: limit,
        stall: limit,
        drain: limit,
    };
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let router = Router::new().route("/", get(async || "here"));
    tokio::spawn(serve(
        listener,
        limits,
        plain,
        router,
        CancellationToken::new(),
    ));

    let maximum = getrlimit(Resource::Nofile).maximum;
    let current = Some(64);
    setrlimit(Resource::Nofile, Rlimit { current, maximum }).unwrap();
    // One file is left for the connection's own end, and none for the listener's.
    let mut files: Vec<File> = std::iter::from_fn(|| File::open("/dev/null").ok()).collect();
    files.pop();
    let mut connection = TcpStream::connect(address).await.unwrap();
    let said = timeout(PATIENCE, lines.recv()).await.unwrap().unwrap();
    assert!(said.contains("no connection can be accepted"), "{said}");

    drop(files);
    let request = b"GET / HTTP/1.1\r\nhost: a\r\nconnection: close\r\n\r\n";
    connection.write_all(request).await.unwrap();
    let mut response = String::new();
    let read = connection.read_to_string(&mut response);
    timeout(PATIENCE, read).await.unwrap().unwrap();
    assert!(response.ends_with("here"), "{response}");
}
