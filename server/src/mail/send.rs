//! A letter as it goes over the wire (RFC 5322), and its carrier.

use super::letter::Letter;
use super::relay::Relay;
use super::store;
use crate::alerts::Severity;
use crate::app::App;
use crate::config;
use crate::outbox::{Carrier, Channel, Claimed, Tried};
use anyhow::{Context, Result};
use lettre::address::Envelope;
use lettre::message::header::{ContentType, HeaderName, HeaderValue};
use lettre::message::{Mailbox, Message};
use reqwest::Url;
use std::fs;
use std::time::{Duration, UNIX_EPOCH};

/// What sends mail.
#[derive(Clone)]
pub struct Mailer {
    relay: Relay,
    from: Mailbox,
    /// Where people reach the dashboard, without a slash at the end.
    public_url: String,
}

impl Mailer {
    /// As the settings say; none if they say nothing of mail.
    ///
    /// # Errors
    /// When they make no sense; names the setting, and no password.
    pub fn new(config: &config::Mail) -> Result<Option<Mailer>> {
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
        Ok(Some(Mailer {
            relay,
            from,
            public_url: public_url.trim_end_matches('/').to_owned(),
        }))
    }

    /// The same, with a relay that is tried again after another time.
    #[must_use]
    pub fn with_patience(self, patience: Duration) -> Mailer {
        Mailer {
            relay: self.relay.with_patience(patience),
            ..self
        }
    }

    fn message(&self, claimed: &Claimed, address: &str, least: Severity) -> Result<Message> {
        let letter: Letter = serde_json::from_str(&claimed.body)?;
        let domain = self.from.email.domain();
        let written = u64::try_from(claimed.created_at.0.micros())?;
        let mut builder = Message::builder()
            .from(self.from.clone())
            .to(Mailbox::new(None, address.parse()?))
            .subject(letter.subject.as_str())
            .date(UNIX_EPOCH + Duration::from_micros(written))
            // The same at every try, so that a mailbox can tell a second copy.
            .message_id(Some(format!(
                "<{}.{}@{domain}>",
                claimed.id,
                claimed.receiver_id.simple()
            )))
            .header(ContentType::TEXT_PLAIN);
        if let Some(alert) = letter.alert {
            builder = builder.references(format!("<{alert}@{domain}>"));
        }
        let text = letter.text_for(address, least, &self.public_url);
        let mut message = builder.body(text)?;
        // Nobody's holiday notice is to answer (RFC 3834, section 5).
        message.headers_mut().insert_raw(HeaderValue::new(
            HeaderName::new_from_ascii_str("Auto-Submitted"),
            "auto-generated".to_owned(),
        ));
        Ok(message)
    }
}

impl Carrier for Mailer {
    const CHANNEL: Channel = Channel::Mail;

    async fn carry(&self, app: &App, claimed: &Claimed) -> Result<Tried> {
        let found = store::address(&app.db, claimed.receiver_id).await?;
        let (address, least) = found.context("the recipient was removed")?;
        let message = self.message(claimed, &address, least)?;
        let envelope = Envelope::new(Some(self.from.email.clone()), vec![address.parse()?])?;
        self.relay.hand_over(&envelope, &message.formatted()).await
    }
}
