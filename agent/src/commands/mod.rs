//! Commands: `run`, `status`, `discover`, `enrol`, `rotate-token`, `hold`, `actions`, `page-pin`,
//! `export`, `replay`.
//!
//! Exit code 2 and one line for a mistake in the user's input, 1 for every other failure.

mod bad_input;
mod configuration;
mod discover;
mod enrolment;
mod local_agent;
mod recordings;
mod signals;

use crate::raw_log::Span;
use crate::run;
use crate::sampler::Exclusion;
use anyhow::Context;
use bad_input::BadInput;
use clap::{CommandFactory, Parser, Subcommand, ValueEnum};
use configuration::{load, load_to_run, load_with_files};
use discover::discover;
use enrolment::{enrol, rotate_token};
use local_agent::{actions, page_pin, set_exclusion, status};
use recordings::{Options, export, parse_time, replay};
use signals::stop_on_signals;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;
use tokio_util::sync::CancellationToken;

/// Binnacle's shipboard agent: sends settled compass headings to the server and puts the corrected
/// heading out to the bridge.
#[derive(Debug, Parser)]
#[command(name = "binnacle-agent", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Reads the instruments, sends samples to the server, puts the corrected heading out.
    ///
    /// The `profile` of `[uplink]` in the configuration sets the upload interval and the daily byte
    /// budget: standard, broadband, vsat, metered, very-metered or short-burst.
    Run {
        /// Configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
    },
    /// Shows the status of the agent.
    Status {
        /// Configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
        /// Prints JSON.
        #[arg(long)]
        json: bool,
    },
    /// Lists every source that is heard, with its rate and last value, and proposes `[roles]`.
    ///
    /// The list is written as comments, so that the output can be added to the configuration.
    Discover {
        /// Configuration file with the `[inputs]`.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
        /// Seconds to listen; recordings are read to their end.
        #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=86_400))]
        seconds: u32,
        /// Prints JSON.
        #[arg(long)]
        json: bool,
    },
    /// Exchanges the one-time code from the dashboard for a token, which is stored in the data
    /// directory.
    Enrol {
        /// URL of the server, as `https://binnacle.example`.
        #[arg(long)]
        server: String,
        /// One-time code.
        #[arg(long)]
        code: String,
        /// Configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
    },
    /// Replaces the agent's token by a new one, also while the agent runs.
    RotateToken {
        /// Configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
    },
    /// Stops sampling while something outside the vessel's own magnetism disturbs the compass, or
    /// resumes it.
    Hold {
        /// Configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
        /// Reason, or `off`.
        hold: HoldArgument,
    },
    /// Lists what people altered on board: time, address, action and result.
    Actions {
        /// Configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
        /// Number of actions, counted from the latest.
        #[arg(long, default_value_t = 100)]
        last: u32,
    },
    /// Reads a PIN of 6 to 12 digits from standard input, and prints the line for `[page]` in the
    /// configuration that makes changes on the page need it.
    PagePin,
    /// Writes the readings of each second in the raw log as CSV: for download in port, also while
    /// the agent runs.
    Export {
        /// Configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
        /// First time to export, as `2026-11-21T06:00:00Z`.
        #[arg(long)]
        from: Option<String>,
        /// Time before which the export ends.
        #[arg(long)]
        until: Option<String>,
        /// File for the table, instead of standard output.
        #[arg(long)]
        csv: Option<PathBuf>,
    },
    /// Replays recordings through the same sampler: samples as CSV, notes and a tally as JSON on
    /// standard error.
    Replay {
        /// Recordings in any order, compressed by gzip or not: lines with a sentence or a Signal K
        /// delta, with or without a time and a device's name before it.
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// Configuration with `[roles]` and `[silence]`; conventional talkers without it.
        #[arg(long)]
        config: Option<PathBuf>,
        /// File for the samples, instead of standard output.
        #[arg(long)]
        csv: Option<PathBuf>,
        /// Times that the receiver's week count has rolled over: each adds 1024 weeks to its dates.
        #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=2))]
        roll_over: u8,
    },
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum HoldArgument {
    /// Alongside.
    Berthed,
    /// Magnetic cargo or gear on board.
    MagneticCargo,
    /// Degaussing coils on, or treatment under way.
    Degaussing,
    /// Resume sampling.
    Off,
}

impl HoldArgument {
    fn exclusion(self) -> Option<Exclusion> {
        match self {
            HoldArgument::Berthed => Some(Exclusion::Berthed),
            HoldArgument::MagneticCargo => Some(Exclusion::MagneticCargo),
            HoldArgument::Degaussing => Some(Exclusion::Degaussing),
            HoldArgument::Off => None,
        }
    }
}

/// Returns the commands and their arguments, for the manual page.
pub fn command_line() -> clap::Command {
    Cli::command()
}

/// Runs the command line and returns the exit code of the process.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    start_logging();
    match execute(cli.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Nothing can be reported when standard error is closed.
            writeln!(std::io::stderr(), "binnacle-agent: {error:#}").ok();
            ExitCode::from(if error.is::<BadInput>() { 2 } else { 1 })
        }
    }
}

fn start_logging() {
    use tracing_subscriber::EnvFilter;
    let filter = EnvFilter::try_from_env("BINNACLE_LOG").unwrap_or_else(|_| EnvFilter::new("info"));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(false)
        .init();
}

fn execute(command: Command) -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .context("cannot start")?;
    let done = runtime.block_on(async {
        match command {
            Command::Run { config } => {
                let config = load_to_run(&config)?;
                let shutdown = CancellationToken::new();
                stop_on_signals(&shutdown)?;
                run::run(config, shutdown).await
            }
            Command::Status { config, json } => status(&load(&config)?, json).await,
            Command::Discover {
                config,
                seconds,
                json,
            } => {
                let listen = Duration::from_secs(seconds.into());
                discover(load_with_files(&config)?, listen, json).await
            }
            Command::Enrol {
                server,
                code,
                config,
            } => enrol(&load_with_files(&config)?, &server, &code).await,
            Command::RotateToken { config } => rotate_token(&load_with_files(&config)?).await,
            Command::Hold { config, hold } => {
                set_exclusion(&load(&config)?, hold.exclusion()).await
            }
            Command::Actions { config, last } => actions(&load(&config)?, last).await,
            Command::PagePin => page_pin(),
            Command::Export {
                config,
                from,
                until,
                csv,
            } => {
                let span = Span {
                    from: parse_time("--from", from.as_deref())?,
                    until: parse_time("--until", until.as_deref())?,
                };
                tokio::task::block_in_place(|| export(&load(&config)?, span, csv.as_deref()))
            }
            Command::Replay {
                files,
                config,
                csv,
                roll_over,
            } => {
                let options = Options {
                    config: config.as_deref(),
                    csv: csv.as_deref(),
                    roll_overs: roll_over,
                };
                tokio::task::block_in_place(|| replay(&files, options))
            }
        }
    });
    // A name lookup without a network may run for half a minute more.
    runtime.shutdown_background();
    done
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commands_are_well_formed() {
        command_line().debug_assert();
    }
}
