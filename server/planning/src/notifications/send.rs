//! Letters from notifications that are due: one by itself, several together.
//!
//! What always holds: what is taken for a letter and the letter are one transaction, so
//! that nothing is told twice or never; what was read meanwhile is not told any more.

use super::notification::Notification;
use super::{digest, needs, store};
use binnacle_platform::app::App;
use binnacle_platform::db::{Tx, row};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{DeliveryId, FirmId, OperatorId, UserId};
use binnacle_platform::outbox::{self, Channel, Message};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use std::time::Duration;
use tracing::error;

/// Interval between looks for letters that are due.
const LOOK_EVERY: Duration = Duration::from_secs(5);
/// Looks between checks of urgent needs and of expired notifications.
const SELDOM: u32 = 180;

/// Looks after notifications until the server stops.
pub async fn watch(app: App) {
    let mut looks: u32 = 0;
    while !app.stopping.is_cancelled() {
        if looks.is_multiple_of(SELDOM)
            && let Err(error) = seldom(&app).await
        {
            error!(?error, "needs cannot be looked for");
        }
        looks = looks.wrapping_add(1);
        if let Err(error) = post(&app).await {
            error!(?error, "letters cannot be made");
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(LOOK_EVERY) => {}
        }
    }
}

async fn seldom(app: &App) -> Result<()> {
    needs::look(app).await?;
    store::prune(&app.db, app.clock.now().into()).await?;
    Ok(())
}

/// Makes the letters that are due, and queues them; to how many people.
pub async fn post(app: &App) -> Result<usize> {
    let now = app.clock.now().into();
    let due = store::due(&app.db, now).await?;
    for (user,) in &due {
        let mut tx = app.db.begin().await?;
        let taken = store::take_due(&mut tx, *user, now).await?;
        if app.config.mail.is_set_up() {
            queue(&mut tx, *user, taken, now).await?;
        }
        tx.commit().await?;
    }
    Ok(due.len())
}

async fn queue(tx: &mut Tx, user: UserId, mut taken: Vec<Notification>, now: Time) -> Result<()> {
    taken.retain(|notification| notification.read_at.is_none());
    let Some(tenant) = tenant(tx, user).await? else {
        return Ok(());
    };
    let (urgent, others): (Vec<_>, Vec<_>) = taken.into_iter().partition(|told| told.urgent);
    for together in [urgent, others] {
        let Some(letter) = digest::letter_of(&together) else {
            continue;
        };
        outbox::ensure(tx, tenant, user.0, Channel::Mail).await?;
        let message = Message {
            id: DeliveryId::new(),
            kind: outbox::Kind::Notification,
            order: None,
            body: letter?,
        };
        outbox::queue(tx, user.0, &message, now).await?;
    }
    Ok(())
}

async fn tenant(tx: &mut Tx, user: UserId) -> Result<Option<Tenant>> {
    let found = row!(
        in tx,
        (Option<OperatorId>, Option<FirmId>),
        "SELECT operator_id, firm_id FROM users
         WHERE id = $1 AND disabled_at IS NULL
         ORDER BY id",
        user
    )?;
    Ok(
        found
            .and_then(|(operator, firm)| operator.map(Tenant::Operator).or(firm.map(Tenant::Firm))),
    )
}
