//! Letters as messages (RFC 5322), and their carrier.

use super::letter::{Letter, Reason, wrapped};
use super::mailing_list::{Content, Files, MailingList, TopicList};
use super::relay::Relay;
use super::store;
use crate::app::App;
use crate::config;
use crate::db::{self, Db};
use crate::outbox::{Attempt, Carrier, Channel, Claimed};
use crate::time::Time;
use anyhow::{Context, Result};
use lettre::address::Envelope;
use lettre::message::header::{ContentType, HeaderName, HeaderValue};
use lettre::message::{Attachment, Mailbox, Message, MessageBuilder, MultiPart, SinglePart};
use reqwest::Url;
use std::fs;
use std::time::{Duration, UNIX_EPOCH};
use uuid::Uuid;

/// Sender of mail.
#[derive(Clone)]
pub struct Mailer {
    relay: Relay,
    from: Mailbox,
    /// Public URL of the dashboard, without a trailing slash.
    public_url: String,
    /// Words of the list for topics of a minimum severity.
    topics: TopicList,
    /// Mailing list of another capability.
    list: Option<MailingList>,
}

/// Recipient of a letter, with the reason for it.
struct Addressee {
    address: String,
    reason: Reason,
}

impl Mailer {
    /// Creates the sender from the settings; `None` if mail is not set up.
    ///
    /// # Errors
    /// Fails when a setting is not valid. The error names the setting, but no password.
    pub fn new(config: &config::Mail, topics: TopicList) -> Result<Option<Mailer>> {
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
            topics,
            list: None,
        }))
    }

    /// Returns the sender with a mailing list of another capability.
    #[must_use]
    pub fn with_list(self, list: MailingList) -> Mailer {
        Mailer {
            list: Some(list),
            ..self
        }
    }

    /// Returns the sender with a relay timeout other than the default.
    #[must_use]
    pub fn with_patience(self, patience: Duration) -> Mailer {
        Mailer {
            relay: self.relay.with_patience(patience),
            ..self
        }
    }

    pub(super) fn relay(&self) -> &Relay {
        &self.relay
    }

    /// Builds a letter about the server itself, with its envelope.
    pub(super) fn service_message(
        &self,
        address: &str,
        subject: &str,
        text: &str,
        now: Time,
    ) -> Result<(Envelope, Vec<u8>)> {
        let id = Uuid::now_v7();
        let message = self.addressed(address, now, format!("<{id}@{}>", self.domain()))?;
        let text = format!("{}\n\n{}\n", wrapped("", text), self.public_url);
        let mut message = message
            .subject(subject)
            .header(ContentType::TEXT_PLAIN)
            .body(text)?;
        mark_as_generated(&mut message);
        Ok((self.envelope(address)?, message.formatted()))
    }

    fn domain(&self) -> &str {
        self.from.email.domain()
    }

    fn envelope(&self, address: &str) -> Result<Envelope> {
        let from = Some(self.from.email.clone());
        Ok(Envelope::new(from, vec![address.parse()?])?)
    }

    fn addressed(&self, address: &str, written: Time, id: String) -> Result<MessageBuilder> {
        let written = u64::try_from(written.0.micros())?;
        Ok(Message::builder()
            .from(self.from.clone())
            .to(Mailbox::new(None, address.parse()?))
            .date(UNIX_EPOCH + Duration::from_micros(written))
            .message_id(Some(id)))
    }

    /// Finds the addressee of a receiver's letters; `None` if removed or disabled.
    async fn find_addressee(&self, db: &Db, receiver: Uuid) -> db::Result<Option<Addressee>> {
        if let Some((address, least)) = store::find_listed(db, receiver).await? {
            let reason = Reason::Listed(self.topics, least);
            return Ok(Some(Addressee { address, reason }));
        }
        if let Some(list) = self.list
            && let Some(address) = (list.find_address)(db, receiver).await?
        {
            let reason = Reason::MailingList(list);
            return Ok(Some(Addressee { address, reason }));
        }
        // A person is a receiver under their own id.
        let person = store::find_person(db, receiver).await?;
        let reason = Reason::Person;
        Ok(person.map(|address| Addressee { address, reason }))
    }

    fn message(
        &self,
        claimed: &Claimed,
        letter: &Letter,
        to: &Addressee,
        files: Option<Files>,
    ) -> Result<Message> {
        let domain = self.domain();
        // The id is the same at every attempt, so that a mailbox can detect a second copy.
        let id = format!("<{}.{}@{domain}>", claimed.id, claimed.receiver_id.simple());
        let mut builder = self
            .addressed(&to.address, claimed.created_at, id)?
            .subject(letter.subject.as_str());
        if let Some(about) = letter.about {
            builder = builder.references(format!("<{about}@{domain}>"));
        }
        let text = letter.text_for(&to.address, to.reason, &self.public_url);
        let mut message = match files {
            None => builder.header(ContentType::TEXT_PLAIN).body(text)?,
            Some(files) => builder.multipart(with_files(text, files)?)?,
        };
        mark_as_generated(&mut message);
        Ok(message)
    }
}

/// Suppresses automatic replies, such as holiday notices (RFC 3834, section 5).
fn mark_as_generated(message: &mut Message) {
    message.headers_mut().insert_raw(HeaderValue::new(
        HeaderName::new_from_ascii_str("Auto-Submitted"),
        "auto-generated".to_owned(),
    ));
}

/// Builds the body of a letter with files.
fn with_files(text: String, files: Files) -> Result<MultiPart> {
    let mut body = MultiPart::mixed().singlepart(SinglePart::plain(text));
    for file in files {
        let media_type = ContentType::parse(file.media_type)?;
        let attachment = Attachment::new(file.name);
        body = body.singlepart(match file.content {
            Content::Text(text) => attachment.body(text, media_type),
            Content::Binary(bytes) => attachment.body(bytes, media_type),
        });
    }
    Ok(body)
}

impl Carrier for Mailer {
    const CHANNEL: Channel = Channel::Mail;

    async fn carry(&self, app: &App, claimed: &Claimed) -> Result<Attempt> {
        let found = self.find_addressee(&app.db, claimed.receiver_id).await?;
        let to = found.context("the recipient was removed or disabled")?;
        let letter: Letter = serde_json::from_str(&claimed.body)?;
        let files = match (&letter.files, self.list) {
            (Some(of), Some(list)) => (list.load_files)(&app.db, of).await?,
            _ => None,
        };
        let message = self.message(claimed, &letter, &to, files)?;
        let envelope = self.envelope(&to.address)?;
        self.relay.hand_over(&envelope, &message.formatted()).await
    }
}
