//! Which news of an alert becomes a letter, and to whom.

use super::letter::Letter;
use super::store;
use crate::alerts::{Alert, AlertNews, Severity};
use crate::db::Tx;
use crate::error::Result;
use crate::ids::{OperatorId, RecipientId};
use crate::outbox::{self, Kind, Message};
use crate::time::Time;

/// Queues letters about alerts for those of an operator's recipients who want them.
pub async fn announce(
    tx: &mut Tx,
    operator: OperatorId,
    all: &[AlertNews],
    now: Time,
) -> Result<()> {
    for (recipient, least) in store::wishes(tx, operator).await? {
        for news in all {
            let is_news = note(tx, recipient, least, news).await?;
            if is_news && !is_replaced(news, all) {
                let message = Message {
                    id: news.id,
                    kind: news.kind,
                    order: None,
                    body: serde_json::to_string(&Letter::of(news))?,
                };
                outbox::queue(tx, recipient.0, &message, now).await?;
            }
        }
    }
    Ok(())
}

/// Whether the letter of the next alert of the cause says more than that this one is
/// over.
fn is_replaced(news: &AlertNews, all: &[AlertNews]) -> bool {
    let of = |alert: &Alert| (alert.compass_id, alert.cause);
    news.kind == Kind::AlertCleared
        && all
            .iter()
            .any(|other| other.kind == Kind::AlertRaised && of(&other.alert) == of(&news.alert))
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
        _ => Ok(false),
    }
}
