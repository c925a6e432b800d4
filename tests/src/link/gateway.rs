//! A gateway between a ship and its server: it passes connections on, or
//! misbehaves.

use anyhow::{Context, Result, bail};
use std::net::SocketAddr;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt, copy_bidirectional};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::task::JoinHandle;
use tokio::time::{interval, timeout};

/// The treatment of connections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Behaviour {
    /// Passes everything.
    Passes,
    /// Responds with the login page of a harbour's network.
    ShowsPage,
    /// Responds with a server error.
    Fails,
    /// Refuses with this status, in JSON.
    Refuses(&'static str),
    /// Passes this many bytes each way, then cuts the connection.
    CutsAfter(u64),
    /// Starts a response, then sends a byte of it twice a second, forever.
    Drips,
}

/// Much shorter than the silence that the agent accepts.
const DRIP: Duration = Duration::from_millis(500);

const PAGE: &str = "<html><body>Welcome to Harbour Wi-Fi</body></html>";
const REFUSAL: &str = r#"{"title":"no route matched","message":"sign in first"}"#;

/// A gateway before a server; its own responses are without TLS.
#[derive(Debug)]
pub struct Gateway {
    scheme: String,
    address: SocketAddr,
    behaviour: watch::Sender<Behaviour>,
    ended: watch::Receiver<u64>,
    task: JoinHandle<()>,
}

impl Gateway {
    /// Opens a gateway before a server's URL; it passes everything.
    ///
    /// # Errors
    /// Fails when there is no port, or the URL has no address.
    pub async fn open(server: &str) -> Result<Gateway> {
        let (scheme, server) = server.split_once("://").context("a URL")?;
        let server: SocketAddr = server.parse().context("an address")?;
        let listener = TcpListener::bind("127.0.0.1:0").await?;
        let address = listener.local_addr()?;
        let (behaviour, mut current) = watch::channel(Behaviour::Passes);
        let (count, ended) = watch::channel(0);
        let task = tokio::spawn(async move {
            while let Ok((ship, _)) = listener.accept().await {
                let now = *current.borrow_and_update();
                let mut changed = current.clone();
                let count = count.clone();
                tokio::spawn(async move {
                    // A change ends open connections, so that none continues
                    // with the old behaviour.
                    tokio::select! {
                        _ = handle(ship, server, now) => {}
                        _ = changed.changed() => {}
                    }
                    count.send_modify(|ended| *ended += 1);
                });
            }
        });
        Ok(Gateway {
            scheme: scheme.to_owned(),
            address,
            behaviour,
            ended,
            task,
        })
    }

    /// The server's URL as the ship knows it.
    pub fn url(&self) -> String {
        format!("{}://{}", self.scheme, self.address)
    }

    /// Changes the behaviour, for open connections too.
    pub fn set(&mut self, behaviour: Behaviour) {
        self.behaviour.send_replace(behaviour);
        self.ended.mark_unchanged();
    }

    /// Number of connections that have ended.
    pub fn count(&self) -> u64 {
        *self.ended.borrow()
    }

    /// Waits until `more` further connections have ended.
    ///
    /// # Errors
    /// Fails when they do not within the time.
    pub async fn wait_for_connections(&mut self, more: u64, within: Duration) -> Result<()> {
        let enough = *self.ended.borrow() + more;
        let waiting = self.ended.wait_for(|ended| *ended >= enough);
        match timeout(within, waiting).await {
            Ok(ended) => ended.map(drop).context("the gateway has ended"),
            Err(_) => bail!("the ship did not call {more} times"),
        }
    }
}

impl Drop for Gateway {
    fn drop(&mut self) {
        self.task.abort();
    }
}

async fn handle(mut ship: TcpStream, server: SocketAddr, behaviour: Behaviour) -> Result<()> {
    match behaviour {
        Behaviour::Passes => {
            let mut server = TcpStream::connect(server).await?;
            copy_bidirectional(&mut ship, &mut server).await?;
        }
        Behaviour::ShowsPage => respond(ship, "200 OK", PAGE).await?,
        Behaviour::Drips => drip(ship).await?,
        Behaviour::Refuses(status) => respond(ship, status, REFUSAL).await?,
        Behaviour::Fails => respond(ship, "500 Internal Server Error", "oh").await?,
        Behaviour::CutsAfter(bytes) => {
            let server = TcpStream::connect(server).await?;
            let (from_ship, mut to_ship) = ship.into_split();
            let (from_server, mut to_server) = server.into_split();
            let (mut up, mut down) = (from_ship.take(bytes), from_server.take(bytes));
            // The first direction to use up its bytes ends both.
            tokio::select! {
                _ = tokio::io::copy(&mut up, &mut to_server) => {}
                _ = tokio::io::copy(&mut down, &mut to_ship) => {}
            }
        }
    }
    Ok(())
}

/// Never ends: the client must give up.
async fn drip(mut ship: TcpStream) -> Result<()> {
    let mut ticks = interval(DRIP);
    ship.write_all(b"HTTP/1.1 200 OK\r\ncontent-length: 1000000\r\n\r\n")
        .await?;
    loop {
        ticks.tick().await;
        ship.write_all(b" ").await?;
    }
}

/// Reads the head of a request, responds, and discards the rest.
async fn respond(mut ship: TcpStream, status: &str, body: &str) -> Result<()> {
    let mut head = Vec::new();
    while !head.windows(4).any(|end| end == b"\r\n\r\n") {
        if ship.read_buf(&mut head).await? == 0 {
            return Ok(());
        }
    }
    let length = body.len();
    let response = format!(
        "HTTP/1.1 {status}\r\ncontent-type: text/html\r\nconnection: close\r\n\
         content-length: {length}\r\n\r\n{body}"
    );
    ship.write_all(response.as_bytes()).await?;
    ship.shutdown().await?;
    tokio::io::copy(&mut ship, &mut tokio::io::sink()).await?;
    Ok(())
}
