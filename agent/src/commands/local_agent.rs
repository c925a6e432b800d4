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

/// The running agent answers at once or not at all.
const LOCAL_TIMEOUT: Duration = Duration::from_secs(5);

pub(super) async fn status(config: &Config, json: bool) -> anyhow::Result<()> {
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

/// The status of the running agent; none when none answers.
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
    // A running agent looks into the spool every second, but obeys its page at once.
    spool.set_exclusion(exclusion).await?;
    if let Some(page) = find_page(&spool).await {
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

async fn find_page(spool: &Spool) -> Option<SocketAddr> {
    let mut address = spool.page_address().await.ok()??;
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
