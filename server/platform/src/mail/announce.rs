//! Letters about topics whose severity rises and falls, and their recipients.

use super::letter::Letter;
use super::store;
use crate::db::Tx;
use crate::error::Result;
use crate::ids::{DeliveryId, OperatorId, RecipientId};
use crate::outbox::{self, Kind, Message};
use crate::severity::Severity;
use crate::time::Time;
use uuid::Uuid;

/// Announcement about a topic, for recipients with a minimum severity.
#[derive(Clone, Debug)]
pub struct Announcement {
    /// Id of the delivery.
    pub id: DeliveryId,
    /// Kind of the message that carries the letter.
    pub kind: Kind,
    /// Phase of the topic that is announced.
    pub phase: Phase,
    /// Topic: each recipient gets a letter when it gets worse, and when it ends.
    pub topic: Uuid,
    /// Name that successive topics have in common.
    pub series: String,
    /// Severity of the topic now.
    pub severity: Severity,
    /// Letter to send.
    pub letter: Letter,
}

/// Phase of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The topic has started, or has started again.
    Started,
    /// The severity of the topic has changed.
    Updated,
    /// The topic has ended.
    Ended,
}

/// Queues letters for the recipients of an operator whose minimum severity is reached.
pub async fn announce(
    tx: &mut Tx,
    operator: OperatorId,
    all: &[Announcement],
    now: Time,
) -> Result<()> {
    for (recipient, least) in store::list_recipients(tx, operator).await? {
        for announcement in all {
            let is_due = note(tx, recipient, least, announcement).await?;
            if is_due && !is_replaced(announcement, least, all) {
                let message = Message {
                    id: announcement.id,
                    kind: announcement.kind,
                    about: None,
                    body: serde_json::to_string(&announcement.letter)?,
                };
                outbox::queue(tx, recipient.0, &message, now).await?;
            }
        }
    }
    Ok(())
}

/// Checks whether the same recipient also gets a letter about the next topic of the series.
/// With that letter the one about the end of this topic is redundant.
fn is_replaced(announcement: &Announcement, least: Severity, all: &[Announcement]) -> bool {
    let is_next = |other: &Announcement| {
        other.phase == Phase::Started
            && other.severity >= least
            && other.series == announcement.series
    };
    announcement.phase == Phase::Ended && all.iter().any(is_next)
}

/// Notes the severity last sent to a recipient. Returns true if a letter is due.
async fn note(
    tx: &mut Tx,
    recipient: RecipientId,
    least: Severity,
    announcement: &Announcement,
) -> Result<bool> {
    let topic = announcement.topic;
    let written = store::last_severity(tx, recipient, topic).await?;
    match announcement.phase {
        Phase::Started | Phase::Updated => {
            let severity = announcement.severity;
            if severity < least {
                // For this recipient the topic has ended.
                store::forget(tx, recipient, topic).await?;
                return Ok(written.is_some());
            }
            if written.is_some_and(|written| severity <= written) {
                return Ok(false);
            }
            store::note_severity(tx, recipient, topic, severity).await?;
            Ok(true)
        }
        Phase::Ended => {
            store::forget(tx, recipient, topic).await?;
            Ok(written.is_some())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mail::TopicList;

    const LIST: TopicList = TopicList {
        subject: "storms",
        promise: "storms reach this address",
    };

    fn announced(phase: Phase, series: &str, severity: Severity) -> Announcement {
        Announcement {
            id: DeliveryId::new(),
            kind: Kind::TEST,
            phase,
            topic: Uuid::now_v7(),
            series: series.to_owned(),
            severity,
            letter: Letter::test(LIST),
        }
    }

    #[test]
    fn an_end_is_announced_if_the_next_topic_is_not() {
        let over = announced(Phase::Ended, "one", Severity::Critical);
        let next = announced(Phase::Started, "one", Severity::Notice);
        let all = [over.clone(), next];
        assert!(is_replaced(&over, Severity::Notice, &all));
        assert!(!is_replaced(&over, Severity::Critical, &all));
        let elsewhere = announced(Phase::Started, "another", Severity::Critical);
        assert!(!is_replaced(
            &over,
            Severity::Notice,
            &[over.clone(), elsewhere]
        ));
    }
}
