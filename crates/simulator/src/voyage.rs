//! `voyage`: writes one ship's sentences and their truth.

use crate::atomic_file::{bad_path, finish, partial_path, write_whole};
use crate::cli::{self, BadInput, VoyageArgs};
use crate::clock;
use crate::line::{TcpLine, send_datagrams};
use anyhow::{Context, Result};
use binnacle_compass::time::Timestamp;
use binnacle_simulator::nmea::Talker;
use binnacle_simulator::ship::Ship;
use binnacle_simulator::truth::TruthRecorder;
use std::fs::File;
use std::io::Write;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use tokio::net::UdpSocket;

const BUFFER_BYTES: usize = 64 * 1024;

/// Destination of the sentences.
enum Sink {
    File(File),
    Tcp(TcpLine),
    Udp(UdpSocket, SocketAddr),
}

pub(crate) async fn run(args: &VoyageArgs) -> Result<ExitCode> {
    let scenario = cli::read_scenario(&args.scenario)?;
    let plan = cli::choose_ship(&scenario, args.ship.as_deref())?;
    let days = cli::check_days(args.days.unwrap_or(scenario.days))?;
    let start = args.start.unwrap_or(scenario.start);
    let seed = args.seed.unwrap_or(scenario.seed);
    let ship = Ship::new(&scenario, plan, seed, start)
        .map_err(|error| BadInput(format!("--start: {error}")))?;
    let mut recorder = TruthRecorder::new(&ship);
    let mut talker = Talker::new(&scenario, ship, seed);
    let until = start.plus_seconds(days * 86_400.0);
    let partial = args.out.as_deref().map(partial_path);
    let mut sink = open(args, partial.as_deref())?;
    let mut buffer = Vec::with_capacity(BUFFER_BYTES + 1024);
    let (began, mut bytes) = (Instant::now(), 0);
    let ahead_s = start.seconds_since(clock::now());
    while talker.next_time() <= until {
        if args.real_time {
            wait_for(talker.next_time(), ahead_s).await;
        }
        talker.write_group(&mut buffer);
        recorder.record(talker.ship());
        if args.real_time || buffer.len() >= BUFFER_BYTES {
            bytes += buffer.len();
            sink.send(&buffer).await?;
            buffer.clear();
        }
    }
    bytes += buffer.len();
    sink.send(&buffer).await?;
    if let (Some(out), Some(partial)) = (&args.out, &partial) {
        finish(partial, out)?;
    }
    if let Some(path) = &args.truth {
        let truth = recorder.truth(&scenario, seed, talker.ship());
        write_whole(path, &serde_json::to_vec(&truth)?)?;
    }
    report(&talker, bytes, began.elapsed())?;
    Ok(ExitCode::SUCCESS)
}

impl Sink {
    async fn send(&mut self, bytes: &[u8]) -> Result<()> {
        match self {
            Sink::File(file) => file.write_all(bytes).context("cannot write the sentences"),
            Sink::Tcp(line) => line.send(bytes).await,
            Sink::Udp(socket, to) => send_datagrams(socket, *to, bytes).await,
        }
    }
}

fn open(args: &VoyageArgs, partial: Option<&Path>) -> Result<Sink> {
    if let Some(path) = partial {
        let file = File::create(path).map_err(|error| bad_path(path, &error))?;
        return Ok(Sink::File(file));
    }
    if let Some(address) = args.tcp_server {
        let line = TcpLine::listen(address)?;
        writeln!(std::io::stderr(), "listening at {}", line.address()?)?;
        return Ok(Sink::Tcp(line));
    }
    let to = args.udp.context("an output is required")?;
    let any = SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0));
    let socket = std::net::UdpSocket::bind(any)?;
    socket.set_broadcast(true)?;
    socket.set_nonblocking(true)?;
    Ok(Sink::Udp(UdpSocket::from_std(socket)?, to))
}

/// Waits until the shifted wall clock shows this time.
async fn wait_for(time: Timestamp, ahead_s: f64) {
    let left_s = time.seconds_since(clock::now()) - ahead_s;
    if left_s > 0.0 {
        tokio::time::sleep(Duration::from_secs_f64(left_s)).await;
    }
}

fn report(talker: &Talker, bytes: usize, took: Duration) -> Result<()> {
    let line = serde_json::json!({
        "ship": talker.ship().plan().name,
        "from": talker.ship().start(),
        "until": talker.ship().time(),
        "groups": talker.groups(),
        "sentences": talker.sentences(),
        "bytes": bytes,
        "seconds": took.as_secs_f64(),
    });
    writeln!(std::io::stderr(), "{line}")?;
    Ok(())
}
