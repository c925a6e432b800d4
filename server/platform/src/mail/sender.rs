//! Letters about the server itself, and what every letter has: its sender, relay and envelope.

use super::letter::wrapped;
use super::relay::Relay;
use crate::config;
use crate::outbox::Attempt;
use crate::time::Time;
use anyhow::{Context, Result, bail};
use lettre::address::Envelope;
use lettre::message::header::{ContentType, HeaderName, HeaderValue};
use lettre::message::{Mailbox, Message, MessageBuilder};
use reqwest::Url;
use std::fs;
use std::time::{Duration, UNIX_EPOCH};
use uuid::Uuid;

/// Sender of letters by a relay.
#[derive(Clone)]
pub struct Sender {
    pub(super) relay: Relay,
    from: Mailbox,
    /// Public URL of the dashboard, without a trailing slash.
    pub(super) public_url: String,
}

impl Sender {
    /// Creates the sender from the settings; `None` if mail is not set up.
    ///
    /// # Errors
    /// Fails when a setting is not valid. The error names the setting, but no password.
    pub fn new(config: &config::Mail) -> Result<Option<Sender>> {
        let (Some(relay), Some(from), Some(public_url)) =
            (&config.smtp_url, &config.mail_from, &config.public_url)
        else {
            return Ok(None);
        };
        let authority = config.smtp_ca.as_ref().map(fs::read).transpose();
        let authority = authority.context("--smtp-ca cannot be read")?;
        let page = Url::parse(public_url).context("--public-url is not a URL")?;
        let name = page.host_str().context("--public-url names no host")?;
        let relay = Relay::new(relay, authority.as_deref(), name).context("--smtp-url")?;
        let from = from.parse().context("--mail-from is not an address")?;
        Ok(Some(Sender {
            relay,
            from,
            public_url: public_url.trim_end_matches('/').to_owned(),
        }))
    }

    /// Returns the sender with a relay timeout other than the default.
    #[must_use]
    pub fn with_patience(self, patience: Duration) -> Sender {
        Sender {
            relay: self.relay.with_patience(patience),
            ..self
        }
    }

    /// Hands a letter over to the relay: paragraphs, then the address of a page. Nothing of it is
    /// stored.
    ///
    /// # Errors
    /// Fails when the relay does not accept it.
    pub async fn write(
        &self,
        address: &str,
        subject: &str,
        paragraphs: &[&str],
        path: &str,
        now: Time,
    ) -> Result<()> {
        let id = Uuid::now_v7();
        let builder = self.addressed(address, now, format!("<{id}@{}>", self.domain()))?;
        let text: Vec<String> = paragraphs.iter().map(|text| wrapped("", text)).collect();
        let text = format!("{}\n\n{}{path}\n", text.join("\n\n"), self.public_url);
        let mut message = builder
            .subject(subject)
            .header(ContentType::TEXT_PLAIN)
            .body(text)?;
        mark_as_generated(&mut message);
        let envelope = self.envelope(address)?;
        match self
            .relay
            .hand_over(&envelope, &message.formatted())
            .await?
        {
            Attempt::Accepted(_) => Ok(()),
            Attempt::Refused(code, reply) | Attempt::Deferred(code, reply) => {
                bail!("the relay replied {code}: {reply}")
            }
        }
    }

    pub(super) fn domain(&self) -> &str {
        self.from.email.domain()
    }

    pub(super) fn envelope(&self, address: &str) -> Result<Envelope> {
        let from = Some(self.from.email.clone());
        Ok(Envelope::new(from, vec![address.parse()?])?)
    }

    pub(super) fn addressed(
        &self,
        address: &str,
        written: Time,
        id: String,
    ) -> Result<MessageBuilder> {
        let written = u64::try_from(written.0.micros())?;
        Ok(Message::builder()
            .from(self.from.clone())
            .to(Mailbox::new(None, address.parse()?))
            .date(UNIX_EPOCH + Duration::from_micros(written))
            .message_id(Some(id)))
    }
}

/// Suppresses automatic replies, such as holiday notices (RFC 3834, section 5).
pub(super) fn mark_as_generated(message: &mut Message) {
    message.headers_mut().insert_raw(HeaderValue::new(
        HeaderName::new_from_ascii_str("Auto-Submitted"),
        "auto-generated".to_owned(),
    ));
}
