//! Admission to a Signal K server: device access requests (Signal K specification 1.7, "Access
//! requests"), and the TLS of its connections.
//!
//! A server that asks for a token is sent one request; its administrator accepts it on the
//! server's page. Request and token are kept over restarts. An output that shares the connection
//! needs a token that may write.

use super::link::{CONNECT_TIMEOUT, Link};
use crate::config::SignalKConfig;
use reqwest::StatusCode;
use rustls::ClientConfig;
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

/// Permission that a token gives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Permission {
    /// To read.
    #[default]
    ReadOnly,
    /// To read and to send deltas.
    ReadWrite,
}

/// Decision on a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// There is a token.
    Approved,
    /// The server's administrator refused it.
    Denied,
    /// The server takes no requests: it has no security, or does not allow them.
    NotTaken(StatusCode),
}

/// Registration at the server.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Registration {
    client_id: Uuid,
    /// Path of a request that waits for its decision.
    #[serde(default)]
    request: Option<String>,
    #[serde(default)]
    token: Option<String>,
    /// Permission of the token.
    #[serde(default)]
    permission: Permission,
    /// Permission of the request.
    #[serde(default)]
    requested: Permission,
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
            permission: Permission::default(),
            requested: Permission::default(),
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

    /// Returns whether the token may do what is needed; one of the configuration is believed.
    pub(crate) fn has_token_for(&self, config: &SignalKConfig, needed: Permission) -> bool {
        config.token.is_some() || (self.token.is_some() && self.permission >= needed)
    }

    /// Asks for a token and waits until the server's administrator has decided.
    pub(crate) async fn obtain_token(
        &mut self,
        config: &SignalKConfig,
        needed: Permission,
        link: &Link,
    ) -> io::Result<()> {
        if config.token.is_some() {
            return Err(io::Error::other("the server refuses the token"));
        }
        // The server has just refused it.
        self.token = None;
        let waiting = || {
            link.closed(
                "the server wants approval: accept \"Binnacle compass agent\" on its page, \
                 Security, Access Requests",
            );
        };
        match self.request_token(config, needed, waiting).await? {
            Answer::Approved => Ok(()),
            Answer::Denied => {
                link.closed("the server's administrator denied access");
                tokio::time::sleep(DENIED).await;
                Ok(())
            }
            Answer::NotTaken(status) => Err(io::Error::other(format!(
                "the server wants a token, but takes no access request ({status})"
            ))),
        }
    }

    /// Sends a request, unless one waits already, and waits for the decision. `waiting` is called
    /// if there is none yet.
    pub(crate) async fn request_token(
        &mut self,
        config: &SignalKConfig,
        needed: Permission,
        waiting: impl Fn(),
    ) -> io::Result<Answer> {
        let http = client(config)?;
        if self.request.is_none() || self.requested < needed {
            if self.request.is_some() {
                // The server takes one request of a client at a time.
                self.client_id = Uuid::new_v4();
            }
            match self.send_request(config, needed, &http).await? {
                Ok(href) => self.request = Some(href),
                Err(status) => return Ok(Answer::NotTaken(status)),
            }
            self.requested = needed;
            self.store(config)?;
        }
        let address = config.url.rest(self.request.as_deref().unwrap_or_default());
        let mut is_first = true;
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
                    if std::mem::take(&mut is_first) {
                        waiting();
                    }
                    tokio::time::sleep(POLL).await;
                }
                Some(Decision {
                    permission,
                    token: Some(token),
                }) if permission == "APPROVED" => {
                    self.token = Some(token);
                    self.permission = self.requested;
                    self.request = None;
                    self.store(config)?;
                    return Ok(Answer::Approved);
                }
                Some(_) => {
                    self.request = None;
                    self.store(config)?;
                    return Ok(Answer::Denied);
                }
            }
        }
    }

    /// Returns where the request's state is found, or the status with which it was not taken.
    async fn send_request(
        &self,
        config: &SignalKConfig,
        needed: Permission,
        http: &reqwest::Client,
    ) -> io::Result<Result<String, StatusCode>> {
        let request = json!({
            "clientId": self.client_id, "description": DESCRIPTION, "permissions": needed,
        });
        let sent = http.post(config.url.rest(REQUESTS)).json(&request).send();
        let response = sent.await.map_err(io::Error::other)?;
        let status = response.status();
        if !status.is_success() {
            return Ok(Err(status));
        }
        let state: Result<RequestState, _> = response.json().await;
        let href = state.ok().and_then(|state| state.href);
        Ok(href.filter(|href| href.starts_with('/')).ok_or(status))
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
    let Some(roots) = config.load_authorities()? else {
        let builder = ClientConfig::builder().with_platform_verifier();
        return Ok(builder.map_err(io::Error::other)?.with_no_client_auth());
    };
    Ok(ClientConfig::builder()
        .with_root_certificates(roots)
        .with_no_client_auth())
}
