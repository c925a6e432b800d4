//! The commands: `run`, `status`, `enrol`, `rotate-token`, `hold`, `export`, `replay`.
//!
//! Exit code 2 and one line for what the one who typed it got wrong, 1 for
//! everything else that fails.

use crate::atomic_file::write_atomically;
use crate::config::{Config, ConfigError, RolesConfig, SilenceConfig};
use crate::page::{ExclusionRequest, GUARD_HEADER};
use crate::raw_log::{self, Span};
use crate::replay;
use crate::run;
use crate::sampler::Exclusion;
use crate::spool::{Identity, Spool};
use crate::status::{Status, offline_status};
use crate::uplink::{RequestError, ServerClient};
use anyhow::Context;
use binnacle_magnetics::time::Timestamp;
use clap::{Parser, Subcommand, ValueEnum};
use std::io::Write;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;
use tokio_util::sync::CancellationToken;

/// The running agent answers at once or not at all.
const LOCAL_TIMEOUT: Duration = Duration::from_secs(5);

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

/// What the one who typed it got wrong.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct BadInput(String);

impl From<ConfigError> for BadInput {
    fn from(error: ConfigError) -> BadInput {
        BadInput(error.to_string())
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
            Command::Hold { config, hold } => set_exclusion(&load(&config)?, hold).await,
            Command::Export {
                config,
                from,
                until,
                csv,
            } => {
                let span = Span {
                    from: time("--from", from.as_deref())?,
                    until: time("--until", until.as_deref())?,
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

fn load(path: &Path) -> Result<Config, BadInput> {
    let config = Config::load(path)?;
    // A certificate that cannot be used is found now, not at the first upload.
    ServerClient::new(
        config.uplink.pinned_ca.as_deref(),
        &config.uplink.connection_policy(),
    )
    .map_err(|e| BadInput(format!("{e:#}")))?;
    Ok(config)
}

#[cfg(unix)]
fn stop_on_signals(shutdown: &CancellationToken) -> anyhow::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    for kind in [SignalKind::terminate(), SignalKind::interrupt()] {
        let mut signals = signal(kind).context("cannot listen for signals")?;
        let shutdown = shutdown.clone();
        tokio::spawn(async move {
            signals.recv().await;
            shutdown.cancel();
        });
    }
    Ok(())
}

#[cfg(not(unix))]
fn stop_on_signals(shutdown: &CancellationToken) -> anyhow::Result<()> {
    let shutdown = shutdown.clone();
    tokio::spawn(async move {
        tokio::signal::ctrl_c().await.ok();
        shutdown.cancel();
    });
    Ok(())
}

fn time(flag: &str, text: Option<&str>) -> Result<Option<Timestamp>, BadInput> {
    text.map(Timestamp::parse)
        .transpose()
        .map_err(|error| BadInput(format!("{flag}: {error}")))
}

fn export(config: &Config, span: Span, csv: Option<&Path>) -> anyhow::Result<()> {
    let raw_log = raw_log::path(&config.data_dir);
    if !raw_log.exists() {
        return Err(BadInput(format!("{}: there is no ring yet", raw_log.display())).into());
    }
    let rows = match csv {
        Some(path) => write_atomically(path, |out| raw_log::export(&raw_log, span, out))?,
        None => raw_log::export(&raw_log, span, &mut std::io::stdout().lock())?,
    };
    writeln!(std::io::stderr(), "{rows} seconds")?;
    Ok(())
}

fn replay(files: &[PathBuf], config: Option<&Path>, csv: Option<&Path>) -> anyhow::Result<()> {
    let (roles, silence) = match config {
        Some(path) => {
            let config = load(path)?;
            (config.roles, config.silence)
        }
        None => (RolesConfig::usual(), SilenceConfig::default()),
    };
    let replayed =
        replay::replay(files, &roles, silence.stale_s.0).map_err(|e| BadInput(format!("{e:#}")))?;
    let table = replayed.csv()?;
    match csv {
        Some(path) => {
            write_atomically(path, |out| Ok(out.write_all(&table)?))
                .map_err(|e| BadInput(format!("{e:#}")))?;
        }
        None => std::io::stdout().write_all(&table)?,
    }
    writeln!(std::io::stderr(), "{}", replayed.report())?;
    Ok(())
}

async fn status(config: &Config, json: bool) -> anyhow::Result<()> {
    if let Ok(false) = config.data_dir.try_exists() {
        let path = config.data_dir.display();
        return Err(BadInput(format!("{path}: there is no such data directory yet")).into());
    }
    let spool = match Spool::open(&config.data_dir).await {
        Ok(spool) => spool,
        // Of a disk that has failed there is the more to be told.
        Err(error) => Spool::open_to_read(&config.data_dir)
            .await
            .map_err(|_| error)?,
    };
    let status = match ask_running(&spool).await {
        Some(status) => status,
        None => offline_status(&spool).await?,
    };
    let text = if json {
        serde_json::to_string_pretty(&status)? + "\n"
    } else {
        status.text()
    };
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(())
}

/// The status of the running agent; none when none answers.
async fn ask_running(spool: &Spool) -> Option<Status> {
    let url = format!("http://{}/api/status", page_of(spool).await?);
    let response = local_client().ok()?.get(url).send().await.ok()?;
    response.json().await.ok()
}

async fn set_exclusion(config: &Config, argument: HoldArgument) -> anyhow::Result<()> {
    let exclusion = match argument {
        HoldArgument::Berthed => Some(Exclusion::Berthed),
        HoldArgument::MagneticCargo => Some(Exclusion::MagneticCargo),
        HoldArgument::Degaussing => Some(Exclusion::Degaussing),
        HoldArgument::Off => None,
    };
    let spool = Spool::open(&config.data_dir).await?;
    // A running agent looks into the spool every second, but obeys its page at once.
    spool.set_exclusion(exclusion).await?;
    if let Some(page) = page_of(&spool).await {
        let response = local_client()?
            .post(format!("http://{page}/api/hold"))
            .header(GUARD_HEADER, "1")
            .json(&ExclusionRequest { exclusion })
            .send()
            .await;
        if let Err(error) = response {
            tracing::debug!(%error, "no running agent answers");
        }
    }
    let said = exclusion.map_or_else(
        || "sampling resumes".to_owned(),
        |h| format!("on hold: {h}"),
    );
    writeln!(std::io::stdout(), "{said}")?;
    Ok(())
}

async fn page_of(spool: &Spool) -> Option<SocketAddr> {
    let mut address = spool.page().await.ok()??;
    if address.ip().is_unspecified() {
        // Listening everywhere: ask here.
        address.set_ip(match address {
            SocketAddr::V4(_) => std::net::Ipv4Addr::LOCALHOST.into(),
            SocketAddr::V6(_) => std::net::Ipv6Addr::LOCALHOST.into(),
        });
    }
    Some(address)
}

fn local_client() -> reqwest::Result<reqwest::Client> {
    reqwest::Client::builder()
        .no_proxy()
        .timeout(LOCAL_TIMEOUT)
        .build()
}

async fn enrol(config: &Config, server: &str, code: &str) -> anyhow::Result<()> {
    let server = server_url(server)?;
    let client = ServerClient::new(
        config.uplink.pinned_ca.as_deref(),
        &config.uplink.connection_policy(),
    )?;
    let spool = Spool::open(&config.data_dir).await?;
    let answer = match client.enrol(&server, code.trim()).await {
        Ok(answer) => answer,
        Err(
            error @ (RequestError::Unauthorized(_)
            | RequestError::NotFound(_)
            | RequestError::Refused(_)),
        ) => {
            return Err(BadInput(format!("the code was refused: {error}")).into());
        }
        Err(error) => anyhow::bail!("{server}: {error}"),
    };
    let said = format!("enrolled: {}, {}", answer.vessel_name, answer.compass_name);
    spool
        .enrol(&Identity {
            server,
            token: answer.token,
            other_token: None,
            stream: answer.stream,
            vessel_name: answer.vessel_name,
            compass_name: answer.compass_name,
        })
        .await?;
    writeln!(std::io::stdout(), "{said}")?;
    Ok(())
}

/// The new token is kept before the shore is asked to know it, so that an answer that is
/// lost locks nobody out: the agent then tries both.
async fn rotate_token(config: &Config) -> anyhow::Result<()> {
    let client = ServerClient::new(
        config.uplink.pinned_ca.as_deref(),
        &config.uplink.connection_policy(),
    )?;
    let spool = Spool::open(&config.data_dir).await?;
    let Some(identity) = spool.identity().await? else {
        return Err(BadInput("the agent is not enrolled".to_owned()).into());
    };
    let server = &identity.server;
    let failed = |error: RequestError| anyhow::anyhow!("{server}: {error}");
    let new = client.propose_token(&identity).await.map_err(failed)?;
    spool.save_other_token(&new.token).await?;
    client
        .replace_token(&identity, &new)
        .await
        .map_err(failed)?;
    spool.swap_tokens(&identity.token).await?;
    writeln!(std::io::stdout(), "the token was replaced")?;
    Ok(())
}

fn server_url(text: &str) -> Result<String, BadInput> {
    let bad = |why: &str| BadInput(format!("--server {text:?} {why}"));
    let url = reqwest::Url::parse(text).map_err(|e| bad(&format!("is not a URL: {e}")))?;
    if !matches!(url.scheme(), "http" | "https") || url.host().is_none() {
        return Err(bad("is not an http or https URL"));
    }
    if url.query().is_some() || url.fragment().is_some() || !url.username().is_empty() {
        return Err(bad("must be scheme, host, port and path only"));
    }
    if url.scheme() == "http"
        && !matches!(url.host_str(), Some("localhost" | "127.0.0.1" | "[::1]"))
    {
        tracing::warn!("without https, the token travels in the clear");
    }
    Ok(url.as_str().trim_end_matches('/').to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_commands_are_well_formed() {
        use clap::CommandFactory;
        Cli::command().debug_assert();
    }

    #[test]
    fn a_server_is_a_url_without_a_slash_at_its_end() {
        assert_eq!(
            server_url("https://b.example/").unwrap(),
            "https://b.example"
        );
        assert_eq!(
            server_url("http://127.0.0.1:8080").unwrap(),
            "http://127.0.0.1:8080"
        );
        for wrong in [
            "b.example",
            "ftp://b.example",
            "",
            "https://u@b.example",
            "http://x/?q",
        ] {
            assert!(server_url(wrong).is_err(), "{wrong}");
        }
    }
}
