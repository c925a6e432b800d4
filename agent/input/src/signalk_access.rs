//! Admission to a Signal K server: device access requests (Signal K specification 1.7, "Access
//! requests"), and the TLS of its connections.
//!
//! A server that asks for a token is sent one request; its administrator accepts it on the
//! server's page. Request and token are kept over restarts.

use super::link::{CONNECT_TIMEOUT, Link};
use crate::config::SignalKConfig;
use reqwest::StatusCode;
use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject;
use rustls::{ClientConfig, RootCertStore};
use rustls_platform_verifier::BuilderVerifierExt;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::fs;
use std::io;
use std::time::Duration;
use uuid::Uuid;

/// Path of the requests.
const REQUESTS: &str = "/signalk/v1/access/requests";
/// Path of the vessel's data.
const SELF: &str = "/signalk/v1/api/vessels/self";
/// Pause between looks at a request.
const POLL: Duration = Duration::from_secs(5);
/// Pause after a request was denied.
const DENIED: Duration = Duration::from_mins(10);
/// Name of the agent on the server's page.
const DESCRIPTION: &str = "Binnacle compass agent";

/// Registration at the server.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Registration {
    client_id: Uuid,
    /// Path of a request that waits for its decision.
    #[serde(default)]
    request: Option<String>,
    #[serde(default)]
    token: Option<String>,
}

/// State of a request, as the server has it.
#[derive(Debug, Deserialize)]
struct RequestState {
    state: String,
    href: Option<String>,
    #[serde(rename = "accessRequest")]
    decision: Option<Decision>,
}

#[derive(Debug, Deserialize)]
struct Decision {
    permission: String,
    token: Option<String>,
}

impl Registration {
    /// Reads the registration; another one where there is none that can be read.
    pub(crate) fn load(config: &SignalKConfig) -> Registration {
        let text = config
            .registration
            .as_ref()
            .and_then(|path| fs::read_to_string(path).ok());
        let known = text.and_then(|text| serde_json::from_str(&text).ok());
        known.unwrap_or_else(|| Registration {
            client_id: Uuid::new_v4(),
            request: None,
            token: None,
        })
    }

    fn store(&self, config: &SignalKConfig) -> io::Result<()> {
        let Some(path) = &config.registration else {
            return Ok(());
        };
        let text = serde_json::to_vec(self).map_err(io::Error::other)?;
        // A partial file never looks complete.
        let partial = path.with_extension("partial");
        fs::write(&partial, &text)?;
        fs::rename(&partial, path)
    }

    /// Returns the token to connect with.
    pub(crate) fn token<'a>(&'a self, config: &'a SignalKConfig) -> Option<&'a str> {
        config.token.as_deref().or(self.token.as_deref())
    }

    /// Returns whether the server gives nothing to those without a token.
    pub(crate) async fn needs_token(&self, config: &SignalKConfig) -> io::Result<bool> {
        let response = client(config)?.get(config.url.rest(SELF)).send().await;
        let status = response.map_err(io::Error::other)?.status();
        Ok(matches!(
            status,
            StatusCode::UNAUTHORIZED | StatusCode::FORBIDDEN
        ))
    }

    /// Asks for a token and waits until the server's administrator has decided.
    pub(crate) async fn obtain_token(
        &mut self,
        config: &SignalKConfig,
        link: &Link,
    ) -> io::Result<()> {
        if config.token.is_some() {
            return Err(io::Error::other("the server refuses the token"));
        }
        self.token = None;
        self.store(config)?;
        let http = client(config)?;
        if self.request.is_none() {
            self.request = Some(self.send_request(config, &http).await?);
            self.store(config)?;
        }
        let address = config.url.rest(self.request.as_deref().unwrap_or_default());
        loop {
            let response = http.get(&address).send().await.map_err(io::Error::other)?;
            if response.status() == StatusCode::NOT_FOUND {
                // The server has forgotten it.
                self.request = None;
                self.store(config)?;
                return Err(io::Error::other(
                    "the server does not know the request any more",
                ));
            }
            let found: RequestState = response.json().await.map_err(io::Error::other)?;
            match found.decision.filter(|_| found.state == "COMPLETED") {
                None => {
                    link.closed(
                        "the server wants approval: accept \"Binnacle compass agent\" on its page, \
                         Security, Access Requests",
                    );
                    tokio::time::sleep(POLL).await;
                }
                Some(Decision {
                    permission,
                    token: Some(token),
                }) if permission == "APPROVED" => {
                    self.token = Some(token);
                    self.request = None;
                    return self.store(config);
                }
                Some(_) => {
                    link.closed("the server's administrator denied access");
                    tokio::time::sleep(DENIED).await;
                    self.request = None;
                    return self.store(config);
                }
            }
        }
    }

    async fn send_request(
        &self,
        config: &SignalKConfig,
        http: &reqwest::Client,
    ) -> io::Result<String> {
        let request = json!({
            "clientId": self.client_id, "description": DESCRIPTION, "permissions": "readonly",
        });
        let sent = http.post(config.url.rest(REQUESTS)).json(&request).send();
        let response = sent.await.map_err(io::Error::other)?;
        let status = response.status();
        let state: Result<RequestState, _> = response.json().await;
        let href = state.ok().and_then(|state| state.href);
        href.filter(|href| href.starts_with('/')).ok_or_else(|| {
            io::Error::other(format!(
                "the server wants a token, but takes no access request ({status})"
            ))
        })
    }
}

/// Builds the client for requests.
fn client(config: &SignalKConfig) -> io::Result<reqwest::Client> {
    reqwest::Client::builder()
        .tls_backend_preconfigured(tls(config)?)
        .timeout(CONNECT_TIMEOUT)
        .build()
        .map_err(io::Error::other)
}

/// Returns the TLS that trusts the system's authorities, or only the configured one.
pub(crate) fn tls(config: &SignalKConfig) -> io::Result<ClientConfig> {
    let Some(path) = &config.ca else {
        let builder = ClientConfig::builder().with_platform_verifier();
        return Ok(builder.map_err(io::Error::other)?.with_no_client_auth());
    };
    let wrong =
        |error: &dyn std::fmt::Display| io::Error::other(format!("{}: {error}", path.display()));
    let mut roots = RootCertStore::empty();
    for certificate in CertificateDer::pem_file_iter(path).map_err(|e| wrong(&e))? {
        let certificate = certificate.map_err(|e| wrong(&e))?;
        roots.add(certificate).map_err(|e| wrong(&e))?;
    }
    if roots.is_empty() {
        return Err(wrong(&"there is no certificate in it"));
    }
    Ok(ClientConfig::builder()
        .with_root_certificates(roots)
        .with_no_client_auth())
}
