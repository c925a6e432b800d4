//! The commands `status` and `hold`, with or without a running agent.

use super::bad_input::BadInput;
use crate::config::Config;
use crate::page::{ExclusionRequest, GUARD_HEADER};
use crate::sampler::Exclusion;
use crate::spool::Spool;
use crate::status::{Status, offline_status};
use std::io::Write;
use std::net::SocketAddr;
use std::time::Duration;

/// Timeout of requests to the running agent.
const LOCAL_TIMEOUT: Duration = Duration::from_secs(5);

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
    let status = match fetch_running_status(&spool).await {
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

/// Fetches the status of the running agent, `None` when there is no response.
async fn fetch_running_status(spool: &Spool) -> Option<Status> {
    let url = format!("http://{}/api/status", find_page(spool).await?);
    let response = local_client().ok()?.get(url).send().await.ok()?;
    response.json().await.ok()
}

pub(super) async fn set_exclusion(
    config: &Config,
    exclusion: Option<Exclusion>,
) -> anyhow::Result<()> {
    let spool = Spool::open(&config.data_dir).await?;
    // A running agent reads the spool every second, but its page takes effect at once.
    spool.set_exclusion(exclusion).await?;
    if let Some(page) = find_page(&spool).await {
        let response = local_client()?
            .post(format!("http://{page}/api/hold"))
            .header(GUARD_HEADER, "1")
            .json(&ExclusionRequest { exclusion })
            .send()
            .await;
        if let Err(error) = response {
            tracing::debug!(%error, "no running agent responds");
        }
    }
    let said = exclusion.map_or_else(
        || "sampling resumes".to_owned(),
        |h| format!("on hold: {h}"),
    );
    writeln!(std::io::stdout(), "{said}")?;
    Ok(())
}

async fn find_page(spool: &Spool) -> Option<SocketAddr> {
    let mut address = spool.page_address().await.ok()??;
    if address.ip().is_unspecified() {
        // Listening on all addresses: connect to this computer.
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
