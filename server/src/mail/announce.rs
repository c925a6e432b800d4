//! Which news of an alert becomes a letter, and to whom.

use super::letter::Letter;
use super::store;
use crate::alerts::AlertNews;
use crate::alerts::Severity;
use crate::db::Tx;
use crate::error::Result;
use crate::ids::{OperatorId, RecipientId};
use crate::outbox::{self, Kind, Message};
use crate::time::Time;

/// Queues letters about alerts for those of an operator's recipients who want them.
pub async fn announce(
    tx: &mut Tx,
    operator: OperatorId,
    news: &[AlertNews],
    now: Time,
) -> Result<()> {
    for (recipient, least) in store::wishes(tx, operator).await? {
        for news in news {
            if note(tx, recipient, least, news).await? {
                let message = Message {
                    id: news.id,
                    kind: news.kind,
                    body: serde_json::to_string(&Letter::of(news))?,
                };
                outbox::queue(tx, recipient.0, &message, now).await?;
            }
        }
    }
    Ok(())
}

/// Whether a recipient is told this, which is then noted.
async fn note(
    tx: &mut Tx,
    recipient: RecipientId,
    least: Severity,
    news: &AlertNews,
) -> Result<bool> {
    let alert = news.alert.id;
    let told = store::told(tx, recipient, alert).await?;
    match news.kind {
        Kind::AlertRaised | Kind::AlertUpdated => {
            let severity = news.alert.severity;
            if severity < least || told.is_some_and(|told| severity <= told) {
                return Ok(false);
            }
            store::tell(tx, recipient, alert, severity).await?;
            Ok(true)
        }
        Kind::AlertCleared => {
            store::forget(tx, recipient, alert).await?;
            Ok(told.is_some())
        }
        Kind::AlertAcknowledged | Kind::Test => Ok(false),
    }
}
