//! A satellite link between a server and a ship, each in a network of its own.
//!
//! `satellite/link.py` carries the packets with delay, loss and limited rate,
//! and counts them. A test on it calls [`crate::process::namespace::in_own_network`]
//! first: the test's own network is the server's, isolated from the rest of the
//! machine.

use crate::process::program;
use anyhow::{Context, Result, ensure};
use rcgen::{
    BasicConstraints, CertificateParams, DistinguishedName, DnType, IsCa, Issuer, KeyPair,
    PKCS_ED25519, date_time_ymd,
};
use serde::{Deserialize, Serialize};
use std::net::{IpAddr, Ipv4Addr};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader, Lines};
use tokio::process::{Child, ChildStdin, ChildStdout, Command};
use tokio::time::timeout;

/// The server's address on the link.
pub const SERVER: IpAddr = IpAddr::V4(Ipv4Addr::new(10, 77, 0, 1));
/// Address of the ship's instruments.
pub const INSTRUMENTS: IpAddr = IpAddr::V4(Ipv4Addr::new(10, 78, 0, 1));
const START: Duration = Duration::from_secs(30);

/// Conditions on the link; absent ones stay unchanged.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Conditions {
    /// True while packets pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up: Option<bool>,
    /// Round-trip time, milliseconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub round_trip_ms: Option<f64>,
    /// Fraction of packets lost.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loss: Option<f64>,
    /// Bits per second each way; 0 without limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bits_per_s: Option<f64>,
}

/// Packets put on the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub struct Tally {
    /// Sent by the ship.
    pub to_server: Count,
    /// Sent by the server.
    pub to_ship: Count,
}

/// IP packets in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub struct Count {
    /// Number of packets.
    pub packets: u64,
    /// Their bytes, IP headers included.
    pub bytes: u64,
}

impl Tally {
    /// Returns the bytes of both directions.
    pub fn bytes(&self) -> u64 {
        self.to_server.bytes + self.to_ship.bytes
    }
}

/// The link, which is up until it is dropped.
#[derive(Debug)]
pub struct Satellite {
    // Dropped first: closing its input ends the link.
    commands: ChildStdin,
    responses: Lines<BufReader<ChildStdout>>,
    _link: Child,
    ship: u32,
}

#[derive(Deserialize)]
struct Up {
    ship: u32,
}

impl Satellite {
    /// Sets the link up without loss or delay, and the server's host as
    /// docs/uplink.md requires.
    ///
    /// # Errors
    /// Fails when Python or the system does not allow it.
    pub async fn launch() -> Result<Satellite> {
        std::fs::write("/proc/sys/net/ipv4/tcp_timestamps", "0").context("tcp_timestamps")?;
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("satellite/link.py");
        let mut link = Command::new("python3")
            .arg(script)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .kill_on_drop(true)
            .spawn()
            .context("python3")?;
        let commands = link.stdin.take().context("standard input was asked for")?;
        let output = link
            .stdout
            .take()
            .context("standard output was asked for")?;
        let mut satellite = Satellite {
            commands,
            responses: BufReader::new(output).lines(),
            _link: link,
            ship: 0,
        };
        let up: Up = serde_json::from_str(&satellite.read_response().await?)?;
        satellite.ship = up.ship;
        Ok(satellite)
    }

    async fn read_response(&mut self) -> Result<String> {
        let line = timeout(START, self.responses.next_line()).await;
        let line = line.context("the link does not respond")??;
        line.context("the link has ended: see its errors above")
    }

    async fn send(&mut self, mut line: String) -> Result<()> {
        line.push('\n');
        Ok(self.commands.write_all(line.as_bytes()).await?)
    }

    /// Changes the conditions on the link.
    ///
    /// # Errors
    /// Fails when the link has ended.
    pub async fn set(&mut self, conditions: Conditions) -> Result<()> {
        self.send(serde_json::to_string(&conditions)?).await?;
        // A tally shows that the change before it was applied.
        self.tally().await.map(drop)
    }

    /// Returns the packets put on the link so far.
    ///
    /// # Errors
    /// Fails when the link has ended.
    pub async fn tally(&mut self) -> Result<Tally> {
        self.send(r#"{"tally": true}"#.to_owned()).await?;
        Ok(serde_json::from_str(&self.read_response().await?)?)
    }

    /// Returns the ship's network.
    pub fn ship_network(&self) -> ShipNetwork {
        ShipNetwork(self.ship)
    }
}

/// The ship's network, in which programs on board run.
#[derive(Clone, Copy, Debug)]
pub struct ShipNetwork(u32);

impl ShipNetwork {
    /// Returns a command for one of the programs, on board.
    ///
    /// # Errors
    /// Fails when the program is missing.
    pub fn command(&self, name: &str) -> Result<Command> {
        let mut command = Command::new("nsenter");
        command
            .args(["--net", "--target", &self.0.to_string(), "--"])
            .arg(program::path(name)?);
        program::without_settings(&mut command);
        command.stdin(Stdio::null()).kill_on_drop(true);
        Ok(command)
    }
}

/// A private authority and the server's certificate by it, as small files, as
/// docs/uplink.md recommends.
#[derive(Clone, Debug)]
pub struct Certificates {
    server: IpAddr,
    /// PEM of the authority's key.
    issuer_key: String,
    /// The authority's certificate.
    pub authority: PathBuf,
    /// The server's certificate.
    pub chain: PathBuf,
    /// The server's private key.
    pub key: PathBuf,
}

/// Validity of a certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Validity {
    /// Valid now.
    Current,
    /// Expired some years ago.
    Past,
}

impl Certificates {
    /// Makes new certificates for a server at an address, and writes them.
    ///
    /// # Errors
    /// Fails when the folder cannot be written.
    pub fn make(folder: &Path, server: IpAddr) -> Result<Certificates> {
        let issuer_key = KeyPair::generate_for(&PKCS_ED25519)?;
        let of_itself = authority()?.self_signed(&issuer_key)?;
        let made = Certificates {
            server,
            issuer_key: issuer_key.serialize_pem(),
            authority: folder.join("authority.pem"),
            chain: folder.join("chain.pem"),
            key: folder.join("key.pem"),
        };
        std::fs::write(&made.authority, of_itself.pem())?;
        made.renew(Validity::Current)?;
        Ok(made)
    }

    /// Writes certificates of another kind.
    ///
    /// # Errors
    /// Fails when the folder cannot be written.
    pub(super) fn write(
        folder: &Path,
        server: IpAddr,
        authority: &str,
        chain: &str,
        key: &KeyPair,
    ) -> Result<Certificates> {
        let written = Certificates {
            server,
            issuer_key: String::new(),
            authority: folder.join("authority.pem"),
            chain: folder.join("chain.pem"),
            key: folder.join("key.pem"),
        };
        std::fs::write(&written.authority, authority)?;
        std::fs::write(&written.chain, chain)?;
        std::fs::write(&written.key, key.serialize_pem())?;
        Ok(written)
    }

    /// Gives the server another certificate of the same authority.
    ///
    /// # Errors
    /// Fails when the files cannot be written.
    pub fn renew(&self, validity: Validity) -> Result<()> {
        let issuer = Issuer::new(authority()?, KeyPair::from_pem(&self.issuer_key)?);
        let key = KeyPair::generate_for(&PKCS_ED25519)?;
        let mut of_server = CertificateParams::new([self.server.to_string()])?;
        of_server.distinguished_name = short_name();
        if validity == Validity::Past {
            of_server.not_before = date_time_ymd(2019, 1, 1);
            of_server.not_after = date_time_ymd(2020, 1, 1);
        }
        let of_server = of_server.signed_by(&key, &issuer)?;
        std::fs::write(&self.key, key.serialize_pem())?;
        std::fs::write(&self.chain, of_server.pem())?;
        Ok(())
    }
}

/// Short, since names cross the link with every certificate.
fn short_name() -> DistinguishedName {
    let mut name = DistinguishedName::new();
    name.push(DnType::CommonName, "B");
    name
}

fn authority() -> Result<CertificateParams> {
    let mut authority = CertificateParams::new(Vec::<String>::new())?;
    authority.distinguished_name = short_name();
    authority.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
    Ok(authority)
}

/// Fails unless both ends used the link: a test that went around it proves
/// nothing.
///
/// # Errors
/// Fails when one did not use it.
pub fn ensure_used(tally: &Tally) -> Result<()> {
    ensure!(tally.to_server.packets > 0, "the ship never called");
    ensure!(tally.to_ship.packets > 0, "the server never responded");
    Ok(())
}
