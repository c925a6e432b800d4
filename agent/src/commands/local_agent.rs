//! The commands `status`, `hold`, `actions` and `page-pin`, with or without a running agent.

use super::bad_input::BadInput;
use crate::clock;
use crate::config::{Config, Pin};
use crate::sampler::Exclusion;
use crate::spool::{Spool, is_agent_running};
use crate::status::{Status, offline_status, status_socket};
use std::io::Write;

/// Address of actions on the agent's own computer.
const COMMAND_LINE: &str = "command line";

pub(super) async fn status(config: &Config, json: bool) -> anyhow::Result<()> {
    if let Ok(false) = config.data_dir.try_exists() {
        let path = config.data_dir.display();
        return Err(BadInput(format!("{path}: there is no such data directory yet")).into());
    }
    let spool = match Spool::open(&config.data_dir).await {
        Ok(spool) => spool,
        // A failed disk is all the more reason to show the status.
        Err(error) => Spool::open_to_read(&config.data_dir)
            .await
            .map_err(|_| error)?,
    };
    let status = match status_socket::fetch(&config.data_dir).await {
        Ok(status) => status,
        Err(error) => {
            tracing::debug!(error = format!("{error:#}"), "no agent responds");
            Status {
                running: is_agent_running(&config.data_dir),
                ..offline_status(&spool).await?
            }
        }
    };
    let text = if json {
        serde_json::to_string_pretty(&status)? + "\n"
    } else {
        status.text()
    };
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(())
}

/// Stores an exclusion. A running agent reads it within a second.
pub(super) async fn set_exclusion(
    config: &Config,
    exclusion: Option<Exclusion>,
) -> anyhow::Result<()> {
    let spool = Spool::open(&config.data_dir).await?;
    spool.set_exclusion(exclusion).await?;
    let action = Exclusion::action(exclusion);
    spool
        .record_action(clock::now(), COMMAND_LINE, &action, "done")
        .await?;
    let said = exclusion.map_or_else(
        || "sampling resumes".to_owned(),
        |h| format!("on hold: {h}"),
    );
    writeln!(std::io::stdout(), "{said}")?;
    Ok(())
}

/// Lists what people altered on board, the latest last.
pub(super) async fn actions(config: &Config, last: u32) -> anyhow::Result<()> {
    let spool = Spool::open(&config.data_dir).await?;
    let mut out = std::io::stdout().lock();
    for action in spool.actions(last).await?.iter().rev() {
        let at = action.at.to_chrono().format("%Y-%m-%d %H:%M:%S UTC");
        let address = &action.address;
        writeln!(out, "{at}  {address}  {}: {}", action.action, action.result)?;
    }
    Ok(())
}

/// Prints the line of the configuration that sets a PIN, which is read from standard input.
pub(super) fn page_pin() -> anyhow::Result<()> {
    let mut typed = String::new();
    std::io::stdin().read_line(&mut typed)?;
    let pin = Pin::hash(typed.trim()).map_err(BadInput)?;
    writeln!(std::io::stdout(), "pin = \"{pin}\"")?;
    Ok(())
}
