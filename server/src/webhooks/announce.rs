//! Queues what an operator's webhooks want to be told of alerts.

use super::store;
use crate::alerts::AlertNews;
use crate::db::Tx;
use crate::error::Result;
use crate::ids::OperatorId;
use crate::outbox::{self, Message};
use crate::time::Time;
use serde_json::json;

/// Queues news of alerts for those of an operator's webhooks that want them.
pub async fn announce(
    tx: &mut Tx,
    operator: OperatorId,
    news: &[AlertNews],
    now: Time,
) -> Result<()> {
    for (webhook, kinds) in store::wishes(tx, operator).await? {
        let wanted = news.iter().filter(|news| kinds.0.contains(&news.kind));
        for AlertNews { id, kind, alert } in wanted {
            let message = Message {
                id: *id,
                kind: *kind,
                body: json!({ "id": id, "kind": kind, "at": now, "alert": alert }).to_string(),
            };
            outbox::queue(tx, webhook, &message, now).await?;
        }
    }
    Ok(())
}
