//! Queues what webhooks want to be told: an operator's of alerts, and a firm's too of work
//! orders.

use super::store;
use crate::alerts::AlertChange;
use crate::db::Tx;
use crate::error::Result;
use crate::ids::OperatorId;
use crate::outbox::{self, Message};
use crate::tenants::Tenant;
use crate::time::Time;
use serde_json::json;

/// Queues news of alerts for those of an operator's webhooks that want them.
pub async fn announce(
    tx: &mut Tx,
    operator: OperatorId,
    news: &[AlertChange],
    now: Time,
) -> Result<()> {
    for (webhook, kinds) in store::wishes(tx, operator.into()).await? {
        let wanted = news.iter().filter(|news| kinds.0.contains(&news.kind));
        for AlertChange {
            id, kind, alert, ..
        } in wanted
        {
            let message = Message {
                id: *id,
                kind: *kind,
                order: None,
                body: json!({ "id": id, "kind": kind, "at": now, "alert": alert }).to_string(),
            };
            outbox::queue(tx, webhook, &message, now).await?;
        }
    }
    Ok(())
}

/// Queues messages for those of a tenant's webhooks that want them.
pub async fn announce_messages(
    tx: &mut Tx,
    tenant: Tenant,
    messages: &[Message],
    now: Time,
) -> Result<()> {
    if messages.is_empty() {
        return Ok(());
    }
    for (webhook, kinds) in store::wishes(tx, tenant).await? {
        for message in messages
            .iter()
            .filter(|message| kinds.0.contains(&message.kind))
        {
            outbox::queue(tx, webhook, message, now).await?;
        }
    }
    Ok(())
}
