//! Mail of due notifications: a letter for a single one, a digest for several.
//!
//! Invariants: notifications are taken and their letter queued in one transaction, so that each is
//! mailed once. Those read in the meantime are not mailed.

use super::notification::Notification;
use super::{digest, needs, store};
use binnacle_platform::app::App;
use binnacle_platform::db::{Tx, row};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{DeliveryId, FirmId, OperatorId, UserId};
use binnacle_platform::outbox::{self, Channel, Kind, Message};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use binnacle_platform::webhooks::{Audience, DeclaredKind};
use std::time::Duration;
use tracing::error;

/// Notification mail to a user: one notification, or a digest of several.
pub const MESSAGE_KIND: DeclaredKind = DeclaredKind::new(
    Kind::new("notification"),
    Audience::Nobody,
    "A notification is sent as mail.",
);

/// Interval between checks for due mail.
const POLL_INTERVAL: Duration = Duration::from_secs(5);
/// Checks for due mail between two checks for needs and expired notifications.
const POLLS_PER_MAINTENANCE: u32 = 180;

/// Runs the checks until the server stops.
pub async fn watch(app: App) {
    let mut polls: u32 = 0;
    while !app.stopping.is_cancelled() {
        if polls.is_multiple_of(POLLS_PER_MAINTENANCE)
            && let Err(error) = maintain(&app).await
        {
            error!(?error, "cannot check needs");
        }
        polls = polls.wrapping_add(1);
        if let Err(error) = send_due(&app).await {
            error!(?error, "cannot queue mail");
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(POLL_INTERVAL) => {}
        }
    }
}

async fn maintain(app: &App) -> Result<()> {
    needs::notify_of_needs(app).await?;
    store::prune(&app.db, app.clock.now().into()).await?;
    Ok(())
}

/// Queues the mail that is due and returns the number of people it is for.
pub async fn send_due(app: &App) -> Result<usize> {
    let now = app.clock.now().into();
    let due = store::list_due_people(&app.db, now).await?;
    for (user,) in &due {
        let mut tx = app.db.begin().await?;
        let taken = store::take_due(&mut tx, *user, now).await?;
        if app.config.mail.is_set_up() {
            queue_mail(&mut tx, *user, taken, now).await?;
        }
        tx.commit().await?;
    }
    Ok(due.len())
}

async fn queue_mail(
    tx: &mut Tx,
    user: UserId,
    mut taken: Vec<Notification>,
    now: Time,
) -> Result<()> {
    taken.retain(|notification| notification.read_at.is_none());
    let Some(tenant) = find_tenant(tx, user).await? else {
        return Ok(());
    };
    let (urgent, others): (Vec<_>, Vec<_>) = taken
        .into_iter()
        .partition(|notification| notification.urgent);
    for notifications in [urgent, others] {
        let Some(letter) = digest::compose_letter(&notifications) else {
            continue;
        };
        outbox::ensure(tx, tenant, user.0, Channel::Mail).await?;
        let message = Message {
            id: DeliveryId::new(),
            kind: MESSAGE_KIND.kind,
            about: None,
            body: letter?,
        };
        outbox::queue(tx, user.0, &message, now).await?;
    }
    Ok(())
}

async fn find_tenant(tx: &mut Tx, user: UserId) -> Result<Option<Tenant>> {
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
