//! Messages for webhooks.

use super::store;
use crate::db::Tx;
use crate::error::Result;
use crate::outbox::{self, Message};
use crate::tenants::Tenant;
use crate::time::Time;

/// Queues messages for the webhooks of a tenant that subscribe to their kinds.
pub async fn announce(tx: &mut Tx, tenant: Tenant, messages: &[Message], now: Time) -> Result<()> {
    if messages.is_empty() {
        return Ok(());
    }
    for (webhook, kinds) in store::list_subscriptions(tx, tenant).await? {
        for message in messages
            .iter()
            .filter(|message| kinds.includes(message.kind))
        {
            outbox::queue(tx, webhook, message, now).await?;
        }
    }
    Ok(())
}
