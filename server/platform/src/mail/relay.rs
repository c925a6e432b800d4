//! Mail relay: its settings, and the SMTP session with it.
//!
//! Invariants: user and password are sent only over TLS with a checked certificate. A relay
//! without TLS is used only within the local network. No error contains the password.

use crate::outbound::is_public;
use crate::outbox::Attempt;
use anyhow::{Context, Result, bail};
use lettre::address::Envelope;
use lettre::transport::smtp::authentication::{Credentials, Mechanism};
use lettre::transport::smtp::client::{AsyncSmtpConnection, Certificate, TlsParameters};
use lettre::transport::smtp::extension::ClientId;
use percent_encoding::percent_decode_str;
use reqwest::Url;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::time::timeout;

/// Time limit for handing over a letter, after which it is retried; shorter than the lease of a
/// delivery.
pub(super) const PATIENCE: Duration = Duration::from_mins(1);
/// Time limit for the QUIT command after a letter was accepted or refused.
const QUIT_PATIENCE: Duration = Duration::from_secs(2);

/// Mail relay that accepts letters, and the way to reach it.
#[derive(Clone)]
pub struct Relay {
    host: String,
    port: u16,
    security: Security,
    credentials: Option<Credentials>,
    /// Name of this server in the SMTP greeting.
    name: ClientId,
    patience: Duration,
}

#[derive(Clone)]
enum Security {
    /// TLS from the first byte (RFC 8314, section 3.3).
    Tls(TlsParameters),
    /// STARTTLS, without which no mail is sent (RFC 3207).
    StartTls(TlsParameters),
    /// No TLS.
    Nothing,
}

impl Relay {
    /// Parses `smtps://USER:PASSWORD@HOST`, `smtp://…` for STARTTLS, or `smtp://HOST?tls=none`.
    /// `authority` is the PEM of an additional trusted authority, and `name` is the name of this
    /// server in the greeting.
    ///
    /// # Errors
    /// Fails when the URL has another form; the error does not contain it.
    pub fn new(url: &str, authority: Option<&[u8]>, name: &str) -> Result<Relay> {
        let url = Url::parse(url).context("is not a URL")?;
        let host = url.host_str().filter(|host| !host.is_empty());
        let host = host.context("names no host")?.to_owned();
        if !matches!(url.path(), "" | "/") || url.fragment().is_some() {
            bail!("may only have user, password, host, port and tls=none");
        }
        let tls = || tls_parameters(&host, authority);
        let (security, port) = match (url.scheme(), url.query()) {
            ("smtps", None) => (Security::Tls(tls()?), 465),
            ("smtp", None) => (Security::StartTls(tls()?), 587),
            ("smtp", Some("tls=none")) => (Security::Nothing, 25),
            ("smtp" | "smtps", Some(_)) => {
                bail!("may only be followed by ?tls=none, after smtp://")
            }
            _ => bail!("begins with neither smtps:// nor smtp://"),
        };
        let credentials = credentials(&url)?;
        if credentials.is_some() && matches!(security, Security::Nothing) {
            bail!("has a password that would be sent without TLS");
        }
        Ok(Relay {
            port: url.port().unwrap_or(port),
            host,
            security,
            credentials,
            name: ClientId::Domain(name.to_owned()),
            patience: PATIENCE,
        })
    }

    /// Returns the relay with a timeout other than the default.
    #[must_use]
    pub fn with_patience(self, patience: Duration) -> Relay {
        Relay { patience, ..self }
    }

    /// Hands a letter over.
    ///
    /// # Errors
    /// Fails when the relay gave no response to the letter: the fault may be temporary.
    pub(super) async fn hand_over(&self, envelope: &Envelope, letter: &[u8]) -> Result<Attempt> {
        let session = async {
            let mut relay = self.connect().await?;
            let sent = relay.send(envelope, letter).await;
            anyhow::Ok((relay, sent))
        };
        let outcome = timeout(self.patience, session).await;
        let (mut relay, sent) = outcome.context("the relay does not respond")??;
        match sent {
            Ok(response) => {
                // The relay has the letter, whatever happens from now on.
                let _ = timeout(QUIT_PATIENCE, relay.quit()).await;
                Ok(Attempt::Accepted(response.code().into()))
            }
            Err(error) => match error.status() {
                Some(code) if error.is_permanent() => {
                    Ok(Attempt::Refused(code.into(), plain(&error)))
                }
                Some(code) => Ok(Attempt::Deferred(code.into(), plain(&error))),
                None => Err(error.into()),
            },
        }
    }

    async fn connect(&self) -> Result<AsyncSmtpConnection> {
        let found = tokio::net::lookup_host((self.host.as_str(), self.port)).await;
        let addresses: Vec<SocketAddr> = found
            .context("the relay's name cannot be resolved")?
            .collect();
        let without_tls = matches!(self.security, Security::Nothing);
        if without_tls && addresses.iter().any(|address| is_public(address.ip())) {
            bail!("the relay is not within the network, so TLS is required");
        }
        let from_the_start = match &self.security {
            Security::Tls(tls) => Some(tls.clone()),
            Security::StartTls(_) | Security::Nothing => None,
        };
        let patience = Some(self.patience);
        let mut relay = AsyncSmtpConnection::connect_tokio1(
            addresses.as_slice(),
            patience,
            &self.name,
            from_the_start,
            None,
        )
        .await?;
        if let Security::StartTls(tls) = &self.security {
            relay.starttls(tls.clone(), &self.name).await?;
        }
        if let Some(credentials) = &self.credentials {
            let known = [Mechanism::Plain, Mechanism::Login];
            relay.auth(&known, credentials).await?;
        }
        Ok(relay)
    }
}

fn tls_parameters(host: &str, authority: Option<&[u8]>) -> Result<TlsParameters> {
    let mut parameters = TlsParameters::builder(host.to_owned());
    if let Some(authority) = authority {
        let certificate =
            Certificate::from_pem(authority).context("the certificate authority is not PEM")?;
        parameters = parameters.add_root_certificate(certificate);
    }
    Ok(parameters.build_rustls()?)
}

fn credentials(url: &Url) -> Result<Option<Credentials>> {
    let decoded = |text| percent_decode_str(text).decode_utf8();
    match (url.username(), url.password()) {
        ("", None) => Ok(None),
        ("", Some(_)) => bail!("has a password but no user"),
        (_, None) => bail!("has a user but no password"),
        (user, Some(password)) => Ok(Some(Credentials::new(
            decoded(user)?.into_owned(),
            decoded(password)?.into_owned(),
        ))),
    }
}

/// Returns the relay's error message as one line.
fn plain(error: &lettre::transport::smtp::Error) -> String {
    let message = error.to_string();
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(url: &str) -> Option<String> {
        let relay = Relay::new(url, None, "binnacle.example");
        relay.err().map(|error| format!("{error:#}"))
    }

    #[test]
    fn a_relays_address_is_read_or_refused_without_its_password() {
        for good in [
            "smtps://ada:s%40cret@mail.example.com",
            "smtp://ada:secret@mail.example.com:2525",
            "smtp://mail.example.com/",
            "smtp://localhost:25?tls=none",
        ] {
            assert_eq!(problem(good), None, "{good}");
        }
        for bad in [
            "mail.example.com",
            "smtp://",
            "https://ada:secret@example.com",
            "smtp://ada:secret@localhost?tls=none",
            "smtps://ada:secret@example.com?tls=none",
            "smtp://ada:secret@example.com?tls=maybe",
            "smtp://ada:secret@example.com/path",
            "smtp://ada@example.com",
        ] {
            let problem = problem(bad).unwrap_or_else(|| panic!("{bad} is taken"));
            assert!(!problem.contains("secret"), "{problem}");
        }
    }
}
