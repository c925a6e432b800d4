//! The commands `enrol` and `rotate-token`.

use super::bad_input::BadInput;
use crate::config::Config;
use crate::spool::{Identity, Spool};
use crate::uplink::{RequestError, ServerClient, ensure_encrypted};
use axum::http::Uri;
use std::io::Write;

pub(super) async fn enrol(config: &Config, server: &str, code: &str) -> anyhow::Result<()> {
    let server = server_url(server)?;
    if !config.uplink.allow_plain_http {
        ensure_encrypted(&server).map_err(|refused| BadInput(refused.to_string()))?;
    }
    let server = server.to_string().trim_end_matches('/').to_owned();
    let client = ServerClient::new(
        config.uplink.pinned_ca.as_deref(),
        &config.uplink.connection_policy(),
    )?;
    let spool = Spool::open(&config.data_dir).await?;
    let response = match client.enrol(&server, code.trim()).await {
        Ok(response) => response,
        Err(
            error @ (RequestError::Unauthorized(_)
            | RequestError::NotFound(_)
            | RequestError::Refused(_)),
        ) => {
            return Err(BadInput(format!("the code was refused: {error}")).into());
        }
        Err(error) => anyhow::bail!("{server}: {error}"),
    };
    let said = format!(
        "enrolled: {}, {}",
        response.vessel_name, response.compass_name
    );
    spool
        .enrol(&Identity {
            server,
            token: response.token,
            other_token: None,
            stream: response.stream,
            vessel_name: response.vessel_name,
            compass_name: response.compass_name,
        })
        .await?;
    writeln!(std::io::stdout(), "{said}")?;
    Ok(())
}

/// Replaces the agent's token. The new token is stored before the server activates it, so that a
/// lost response locks nobody out: the agent then tries both.
pub(super) async fn rotate_token(config: &Config) -> anyhow::Result<()> {
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

fn server_url(text: &str) -> Result<Uri, BadInput> {
    let bad = |why: &str| BadInput(format!("--server {text:?} {why}"));
    let url = reqwest::Url::parse(text).map_err(|e| bad(&format!("is not a URL: {e}")))?;
    if !matches!(url.scheme(), "http" | "https") || url.host().is_none() {
        return Err(bad("is not an http or https URL"));
    }
    if url.query().is_some() || url.fragment().is_some() || !url.username().is_empty() {
        return Err(bad("must be scheme, host, port and path only"));
    }
    let url = url.as_str().parse();
    url.map_err(|e| bad(&format!("is not a URL: {e}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_server_is_a_url_of_scheme_host_port_and_path() {
        assert_eq!(
            server_url("https://B.example/").unwrap(),
            "https://b.example/"
        );
        assert_eq!(
            server_url("http://127.0.0.1:8080").unwrap(),
            "http://127.0.0.1:8080/"
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
