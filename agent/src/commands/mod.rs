//! The commands: `run`, `status`, `enrol`, `rotate-token`, `hold`, `export`, `replay`.
//!
//! Exit code 2 and one line for what the one who typed it got wrong, 1 for
//! everything else that fails.

mod bad_input;
mod configuration;
mod enrolment;
mod local_agent;
mod recordings;
mod signals;

use crate::raw_log::Span;
use crate::run;
use crate::sampler::Exclusion;
use anyhow::Context;
use bad_input::BadInput;
use clap::{Parser, Subcommand, ValueEnum};
use configuration::load;
use enrolment::{enrol, rotate_token};
use local_agent::{set_exclusion, status};
use recordings::{export, parse_time, replay};
use signals::stop_on_signals;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use tokio_util::sync::CancellationToken;

/// Binnacle's agent on board: settled compass headings to the shore, the
/// corrected heading back to the bridge.
#[derive(Debug, Parser)]
#[command(name = "binnacle-agent", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Listens to the instruments, sends samples ashore, puts the corrected heading out.
    ///
    /// How often it sends, and for how many octets a day, is the `profile` of `[uplink]`
    /// in the configuration: standard, broadband, vsat, metered, very-metered
    /// or short-burst.
    Run {
        /// The configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
    },
    /// Says how the agent is doing.
    Status {
        /// The configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
        /// As JSON.
        #[arg(long)]
        json: bool,
    },
    /// Exchanges the code from the dashboard for a token, which is kept in the data directory.
    Enrol {
        /// Where the shore is, as `https://binnacle.example`.
        #[arg(long)]
        server: String,
        /// The one-time code.
        #[arg(long)]
        code: String,
        /// The configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
    },
    /// Has the shore put a new token in place of the agent's, also while it runs.
    RotateToken {
        /// The configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
    },
    /// Stops sampling while the compass is disturbed from outside, or resumes it.
    Hold {
        /// The configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
        /// Why, or `off`.
        hold: HoldArgument,
    },
    /// Writes what the instruments said in each second, as far back as the ring goes, as
    /// CSV: for download in port, also while the agent runs.
    Export {
        /// The configuration file.
        #[arg(long, default_value = "agent.toml")]
        config: PathBuf,
        /// From this time on, as `2026-11-21T06:00:00Z`.
        #[arg(long)]
        from: Option<String>,
        /// Before this time.
        #[arg(long)]
        until: Option<String>,
        /// Where the table goes, instead of standard output.
        #[arg(long)]
        csv: Option<PathBuf>,
    },
    /// Puts recorded sentences through the same sampler: samples as CSV, a tally
    /// as JSON on standard error.
    Replay {
        /// Recordings in the order of their times: plain sentences, lines of an
        /// RFC 3339 time and a sentence, or TAG blocks with times.
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// Roles and silence are taken from here; talkers' usual roles without it.
        #[arg(long)]
        config: Option<PathBuf>,
        /// Where the samples go, instead of standard output.
        #[arg(long)]
        csv: Option<PathBuf>,
    },
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum HoldArgument {
    /// Alongside.
    Berthed,
    /// Magnetic cargo or gear aboard.
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

/// Runs the command line; the exit code of the process.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    start_logging();
    match execute(cli.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // A closed standard error leaves nobody to tell.
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
                let config = load(&config)?;
                let shutdown = CancellationToken::new();
                stop_on_signals(&shutdown)?;
                run::run(config, shutdown).await
            }
            Command::Status { config, json } => status(&load(&config)?, json).await,
            Command::Enrol {
                server,
                code,
                config,
            } => enrol(&load(&config)?, &server, &code).await,
            Command::RotateToken { config } => rotate_token(&load(&config)?).await,
            Command::Hold { config, hold } => {
                set_exclusion(&load(&config)?, hold.exclusion()).await
            }
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
            Command::Replay { files, config, csv } => {
                tokio::task::block_in_place(|| replay(&files, config.as_deref(), csv.as_deref()))
            }
        }
    });
    // Whoever looks a name up without a network may do so for half a minute more.
    runtime.shutdown_background();
    done
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commands_are_well_formed() {
        use clap::CommandFactory;
        Cli::command().debug_assert();
    }
}
