//! `health`.

use super::operate::block_on;
use crate::cli::Health;
use anyhow::{Context, Result, bail};
use std::process::ExitCode;
use std::time::Duration;

/// Time for the server to answer.
const PATIENCE: Duration = Duration::from_secs(5);

/// Asks a running server whether it is ready, as the health check of a container or a monitor
/// does.
///
/// # Errors
/// Fails when the server does not answer, or answers that it is not ready.
pub fn health(arguments: &Health) -> Result<ExitCode> {
    let url = arguments.url.trim_end_matches('/');
    let said = block_on(async {
        let client = reqwest::Client::builder().timeout(PATIENCE).build()?;
        let answer = client
            .get(format!("{url}/readyz"))
            .send()
            .await
            .with_context(|| format!("no answer from {url}"))?;
        let status = answer.status();
        let said = answer.text().await?;
        if !status.is_success() {
            bail!("{url} is not ready: {said}");
        }
        Ok(said)
    })?;
    super::print(&said)?;
    Ok(ExitCode::SUCCESS)
}
