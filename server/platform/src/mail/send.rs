//! A letter as it goes over the wire (RFC 5322), and its carrier.

use super::letter::{Letter, Why};
use super::monthly::{self, Files};
use super::relay::Relay;
use super::store;
use crate::app::App;
use crate::config;
use crate::outbox::{Carrier, Channel, Claimed, Tried};
use anyhow::{Context, Result};
use lettre::address::Envelope;
use lettre::message::header::{ContentType, HeaderName, HeaderValue};
use lettre::message::{Attachment, Mailbox, Message, MultiPart, SinglePart};
use reqwest::Url;
use std::fs;
use std::time::{Duration, UNIX_EPOCH};

/// Sender of mail.
#[derive(Clone)]
pub struct Mailer {
    relay: Relay,
    from: Mailbox,
    /// Public URL of the dashboard, without a trailing slash.
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

    /// Returns the sender with a relay timeout other than the default.
    #[must_use]
    pub fn with_patience(self, patience: Duration) -> Mailer {
        Mailer {
            relay: self.relay.with_patience(patience),
            ..self
        }
    }

    fn message(
        &self,
        claimed: &Claimed,
        letter: &Letter,
        (address, why): (&str, Why),
        files: Option<Files>,
    ) -> Result<Message> {
        let domain = self.from.email.domain();
        let written = u64::try_from(claimed.created_at.0.micros())?;
        let mut builder = Message::builder()
            .from(self.from.clone())
            .to(Mailbox::new(None, address.parse()?))
            .subject(letter.subject.as_str())
            .date(UNIX_EPOCH + Duration::from_micros(written))
            // The id is the same at every try, so that a mailbox can detect a second copy.
            .message_id(Some(format!(
                "<{}.{}@{domain}>",
                claimed.id,
                claimed.receiver_id.simple()
            )));
        if let Some(about) = letter.about {
            builder = builder.references(format!("<{about}@{domain}>"));
        }
        let text = letter.text_for(address, why, &self.public_url);
        let mut message = match files.zip(letter.report.as_ref()) {
            None => builder.header(ContentType::TEXT_PLAIN).body(text)?,
            Some((files, report)) => builder.multipart(with_files(text, files, &report.month))?,
        };
        // Automatic replies, such as holiday notices, are suppressed (RFC 3834, section 5).
        message.headers_mut().insert_raw(HeaderValue::new(
            HeaderName::new_from_ascii_str("Auto-Submitted"),
            "auto-generated".to_owned(),
        ));
        Ok(message)
    }
}

/// A text and a report's files.
fn with_files(text: String, files: Files, month: &str) -> MultiPart {
    let pdf = ContentType::parse("application/pdf").expect("it is a media type");
    let csv = ContentType::parse("text/csv; charset=utf-8").expect("it is a media type");
    let name = |what: &str, ending: &str| format!("compass-{what}-{month}.{ending}");
    let mut letter = MultiPart::mixed()
        .singlepart(SinglePart::plain(text))
        .singlepart(Attachment::new(name("report", "pdf")).body(files.pdf, pdf));
    for (what, table) in [
        ("due", files.due_csv),
        ("deviation", files.deviation_csv),
        ("jobs", files.jobs_csv),
    ] {
        letter = letter.singlepart(Attachment::new(name(what, "csv")).body(table, csv.clone()));
    }
    letter
}

impl Carrier for Mailer {
    const CHANNEL: Channel = Channel::Mail;

    async fn carry(&self, app: &App, claimed: &Claimed) -> Result<Tried> {
        let found = store::address(&app.db, claimed.receiver_id).await?;
        let (address, why) = found.context("the recipient was removed or is shut out")?;
        let letter: Letter = serde_json::from_str(&claimed.body)?;
        let files = match &letter.report {
            Some(report) => monthly::files(&app.db, report).await?,
            None => None,
        };
        let message = self.message(claimed, &letter, (&address, why), files)?;
        let envelope = Envelope::new(Some(self.from.email.clone()), vec![address.parse()?])?;
        self.relay.hand_over(&envelope, &message.formatted()).await
    }
}
