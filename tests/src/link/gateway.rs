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
pub enum Manners {
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
    manners: watch::Sender<Manners>,
    met: watch::Receiver<u64>,
    task: JoinHandle<()>,
}

impl Gateway {
    /// Opens a gateway before a server's URL; it passes everything.
    ///
    /// # Errors
    /// When there is no port, or the URL has no address.
    pub async fn open(shore: &str) -> Result<Gateway> {
        let (scheme, shore) = shore.split_once("://").context("a URL")?;
        let shore: SocketAddr = shore.parse().context("an address")?;
        let listener = TcpListener::bind("127.0.0.1:0").await?;
        let address = listener.local_addr()?;
        let (manners, mut current) = watch::channel(Manners::Passes);
        let (count, met) = watch::channel(0);
        let task = tokio::spawn(async move {
            while let Ok((ship, _)) = listener.accept().await {
                let now = *current.borrow_and_update();
                let mut changed = current.clone();
                let count = count.clone();
                tokio::spawn(async move {
                    // A change ends open connections, so that none continues
                    // with the old behaviour.
                    tokio::select! {
                        _ = treat(ship, shore, now) => {}
                        _ = changed.changed() => {}
                    }
                    count.send_modify(|met| *met += 1);
                });
            }
        });
        Ok(Gateway {
            scheme: scheme.to_owned(),
            address,
            manners,
            met,
            task,
        })
    }

    /// The server's URL as the ship knows it.
    pub fn url(&self) -> String {
        format!("{}://{}", self.scheme, self.address)
    }

    /// Changes the behaviour, for open connections too.
    pub fn set(&mut self, manners: Manners) {
        self.manners.send_replace(manners);
        self.met.mark_unchanged();
    }

    /// Number of connections that have ended.
    pub fn count(&self) -> u64 {
        *self.met.borrow()
    }

    /// Waits until `more` further connections have ended.
    ///
    /// # Errors
    /// When they do not within the time.
    pub async fn met(&mut self, more: u64, within: Duration) -> Result<()> {
        let enough = *self.met.borrow() + more;
        let waiting = self.met.wait_for(|met| *met >= enough);
        match timeout(within, waiting).await {
            Ok(met) => met.map(drop).context("the gateway has ended"),
            Err(_) => bail!("the ship did not call {more} times"),
        }
    }
}

impl Drop for Gateway {
    fn drop(&mut self) {
        self.task.abort();
    }
}

async fn treat(mut ship: TcpStream, shore: SocketAddr, manners: Manners) -> Result<()> {
    match manners {
        Manners::Passes => {
            let mut shore = TcpStream::connect(shore).await?;
            copy_bidirectional(&mut ship, &mut shore).await?;
        }
        Manners::ShowsPage => answer(ship, "200 OK", PAGE).await?,
        Manners::Drips => drip(ship).await?,
        Manners::Refuses(status) => answer(ship, status, REFUSAL).await?,
        Manners::Fails => answer(ship, "500 Internal Server Error", "oh").await?,
        Manners::CutsAfter(octets) => {
            let shore = TcpStream::connect(shore).await?;
            let (from_ship, mut to_ship) = ship.into_split();
            let (from_shore, mut to_shore) = shore.into_split();
            let (mut up, mut down) = (from_ship.take(octets), from_shore.take(octets));
            // The first direction to use up its bytes ends both.
            tokio::select! {
                _ = tokio::io::copy(&mut up, &mut to_shore) => {}
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
async fn answer(mut ship: TcpStream, status: &str, body: &str) -> Result<()> {
    let mut head = Vec::new();
    while !head.windows(4).any(|end| end == b"\r\n\r\n") {
        if ship.read_buf(&mut head).await? == 0 {
            return Ok(());
        }
    }
    let length = body.len();
    let answer = format!(
        "HTTP/1.1 {status}\r\ncontent-type: text/html\r\nconnection: close\r\n\
         content-length: {length}\r\n\r\n{body}"
    );
    ship.write_all(answer.as_bytes()).await?;
    ship.shutdown().await?;
    tokio::io::copy(&mut ship, &mut tokio::io::sink()).await?;
    Ok(())
}
