//! Letters of the outbox as messages (RFC 5322), and their carrier.

use super::letter::{Letter, Reason};
use super::mailing_list::{Content, Files, MailingList, TopicList};
use super::sender::{Sender, mark_as_generated};
use super::store;
use crate::app::App;
use crate::config;
use crate::db::{self, Db};
use crate::outbox::{Attempt, Carrier, Channel, Claimed};
use anyhow::{Context, Result};
use lettre::message::header::ContentType;
use lettre::message::{Attachment, Message, MultiPart, SinglePart};
use std::time::Duration;
use uuid::Uuid;

/// Carrier of the outbox's letters.
#[derive(Clone)]
pub struct Mailer {
    sender: Sender,
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
    /// Creates the carrier from the settings; `None` if mail is not set up.
    ///
    /// # Errors
    /// Fails when a setting is not valid. The error names the setting, but no password.
    pub fn new(config: &config::Mail, topics: TopicList) -> Result<Option<Mailer>> {
        let sender = Sender::new(config)?;
        Ok(sender.map(|sender| Mailer {
            sender,
            topics,
            list: None,
        }))
    }

    /// Returns the carrier with a mailing list of another capability.
    #[must_use]
    pub fn with_list(self, list: MailingList) -> Mailer {
        Mailer {
            list: Some(list),
            ..self
        }
    }

    /// Returns the carrier with a relay timeout other than the default.
    #[must_use]
    pub fn with_patience(self, patience: Duration) -> Mailer {
        Mailer {
            sender: self.sender.with_patience(patience),
            ..self
        }
    }

    pub(super) fn sender(&self) -> &Sender {
        &self.sender
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
        let domain = self.sender.domain();
        // The id is the same at every attempt, so that a mailbox can detect a second copy.
        let id = format!("<{}.{}@{domain}>", claimed.id, claimed.receiver_id.simple());
        let mut builder = self
            .sender
            .addressed(&to.address, claimed.created_at, id)?
            .subject(letter.subject.as_str());
        if let Some(about) = letter.about {
            builder = builder.references(format!("<{about}@{domain}>"));
        }
        let text = letter.text_for(&to.address, to.reason, &self.sender.public_url);
        let mut message = match files {
            None => builder.header(ContentType::TEXT_PLAIN).body(text)?,
            Some(files) => builder.multipart(with_files(text, files)?)?,
        };
        mark_as_generated(&mut message);
        Ok(message)
    }
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
        let envelope = self.sender.envelope(&to.address)?;
        let relay = &self.sender.relay;
        relay.hand_over(&envelope, &message.formatted()).await
    }
}
