//! The command line: `voyage` and `fleet`.
//!
//! Exit code 2 and one line for bad input; 1 for every other failure, and for a
//! fleet whose models do not hold.

use binnacle_compass::time::Timestamp;
use binnacle_simulator::scenario::{Scenario, ShipPlan};
use clap::{Args, Parser, Subcommand};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

/// Simulates ships, voyages and instruments with NMEA output.
#[derive(Debug, Parser)]
#[command(name = "binnacle-simulator", version)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate one ship and write its sentences to a file, a TCP client or
    /// UDP.
    Voyage(VoyageArgs),
    /// Simulate a fleet with real agents and a real server, and compare the
    /// models with the truth.
    Fleet(FleetArgs),
}

/// Arguments of `voyage`.
#[derive(Debug, Args)]
pub(crate) struct VoyageArgs {
    /// Scenario file with ships, routes and events.
    #[arg(long)]
    pub(crate) scenario: PathBuf,
    /// Random seed; the scenario's by default.
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Name of the ship; the first by default.
    #[arg(long)]
    pub(crate) ship: Option<String>,
    /// Write the sentences to this file.
    #[arg(long, required_unless_present_any = ["tcp_server", "udp"])]
    pub(crate) out: Option<PathBuf>,
    /// Listen at this address and send to the client that connects, waiting
    /// while there is none.
    #[arg(long, conflicts_with_all = ["out", "udp"])]
    pub(crate) tcp_server: Option<SocketAddr>,
    /// Send UDP datagrams to this address.
    #[arg(long, conflicts_with = "out")]
    pub(crate) udp: Option<SocketAddr>,
    /// Simulate in real time instead of as fast as possible.
    #[arg(long)]
    pub(crate) real_time: bool,
    /// Length of the voyage in days; the scenario's by default.
    #[arg(long)]
    pub(crate) days: Option<f64>,
    /// Start of the voyage (RFC 3339); the scenario's by default.
    #[arg(long, value_parser = Timestamp::parse)]
    pub(crate) start: Option<Timestamp>,
    /// Write the true values to this file as JSON.
    #[arg(long)]
    pub(crate) truth: Option<PathBuf>,
}

/// Arguments of `fleet`.
#[derive(Debug, Args)]
pub(crate) struct FleetArgs {
    /// Scenario file with ships, routes and events.
    #[arg(long)]
    pub(crate) scenario: PathBuf,
    /// Random seed; the scenario's by default.
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// URL of the server, for example http://127.0.0.1:8080.
    #[arg(long, required_unless_present = "serve_only")]
    pub(crate) server: Option<String>,
    /// Email of an administrator of the operator; the password comes from
    /// BINNACLE_PASSWORD.
    #[arg(long, required_unless_present = "serve_only")]
    pub(crate) email: Option<String>,
    /// Read the password from standard input.
    #[arg(long)]
    pub(crate) password_stdin: bool,
    /// Path of the program `binnacle-agent`.
    #[arg(long, required_unless_present = "serve_only")]
    pub(crate) agent: Option<PathBuf>,
    /// Folder in which each agent gets a folder of its own.
    #[arg(long, required_unless_present = "serve_only")]
    pub(crate) work_dir: Option<PathBuf>,
    /// Length of the past in days.
    #[arg(long, default_value_t = 60.0)]
    pub(crate) days: f64,
    /// End of the past (RFC 3339); now by default.
    #[arg(long, value_parser = Timestamp::parse)]
    pub(crate) until: Option<Timestamp>,
    /// Continue in real time afterwards.
    #[arg(long)]
    pub(crate) live: bool,
    /// Write the comparison to this file as JSON, or the truth with
    /// --serve-only.
    #[arg(long)]
    pub(crate) report: Option<PathBuf>,
    /// Only serve the sentences: print the addresses as JSON, and keep the
    /// connections open.
    #[arg(long)]
    pub(crate) serve_only: bool,
}

/// A fault in the caller's input.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(crate) struct BadInput(pub(crate) String);

impl BadInput {
    pub(crate) fn new(problem: impl std::fmt::Display) -> BadInput {
        BadInput(problem.to_string())
    }
}

/// Reads the scenario; a fault in it is bad input.
pub(crate) fn read_scenario(path: &Path) -> Result<Scenario, BadInput> {
    Scenario::read(path).map_err(BadInput::new)
}

/// Returns the named ship, or the first.
pub(crate) fn choose_ship<'a>(
    scenario: &'a Scenario,
    name: Option<&str>,
) -> Result<&'a ShipPlan, BadInput> {
    let Some(name) = name else {
        return Ok(&scenario.ships[0]);
    };
    scenario.ship(name).ok_or_else(|| {
        let names: Vec<&str> = scenario
            .ships
            .iter()
            .map(|ship| ship.name.as_str())
            .collect();
        BadInput(format!(
            "--ship: unknown ship {name:?}; the ships are {}",
            names.join(", ")
        ))
    })
}

/// Checks a number of days from the command line.
pub(crate) fn check_days(days: f64) -> Result<f64, BadInput> {
    if (0.001..=3650.0).contains(&days) {
        return Ok(days);
    }
    Err(BadInput(format!(
        "--days: {days} is not within 0.001 to 3650"
    )))
}
