//! Creation of notifications from notices.
//!
//! Invariants: a notice becomes one notification for each person it concerns, in the transaction
//! of the event itself. Each has the time at which mail is due, if any.

use super::channel::Channel;
use super::settings::Settings;
use super::store;
use binnacle_platform::db::{Tx, row, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::UserId;
use binnacle_platform::notices::{DefaultMail, Notice, NoticesPublished};
use binnacle_platform::session::Role;
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use futures_util::future::BoxFuture;

/// Person whom a notice may concern.
struct Person {
    id: UserId,
    role: Role,
    settings: Settings,
}

/// Creates the notifications of a tenant's people, except for the author of the notices.
pub(super) async fn notify(
    tx: &mut Tx,
    tenant: impl Into<Tenant>,
    notices: &[Notice],
    author: Option<UserId>,
    now: Time,
) -> Result<()> {
    if notices.is_empty() {
        return Ok(());
    }
    for person in list_people(tx, tenant.into()).await? {
        let concerns = |notice: &&Notice| {
            notice.kind.readers.include(person.role) && author != Some(person.id)
        };
        for notice in notices.iter().filter(concerns) {
            let way = person.settings.way(notice.kind, person.role);
            if way == Channel::Off {
                continue;
            }
            let mut mail_at = person.settings.mail_at(way, notice.urgent, now);
            if notice.kind.mail == DefaultMail::Recipients
                && is_mail_recipient(tx, person.id).await?
            {
                mail_at = None;
            }
            store::insert(tx, person.id, notice, mail_at, now).await?;
        }
    }
    Ok(())
}

async fn list_people(tx: &mut Tx, tenant: Tenant) -> Result<Vec<Person>> {
    let found = rows!(
        in tx,
        (UserId, Role, Option<String>),
        "SELECT u.id, u.role, s.settings FROM users u
         LEFT JOIN notification_settings s ON s.user_id = u.id
         WHERE (u.operator_id = $1 OR u.firm_id = $2) AND u.disabled_at IS NULL
         ORDER BY u.id",
        tenant.operator(),
        tenant.firm()
    )?;
    let read = |(id, role, settings): (UserId, Role, Option<String>)| {
        let settings = settings
            .map(|text| serde_json::from_str(&text))
            .transpose()?;
        Ok(Person {
            id,
            role,
            settings: settings.unwrap_or_default(),
        })
    };
    found.into_iter().map(read).collect()
}

/// Returns whether a user is one of the operator's mail recipients.
async fn is_mail_recipient(tx: &mut Tx, user: UserId) -> Result<bool> {
    let found = row!(
        in tx,
        (i64,),
        "SELECT COUNT(*) FROM users u
         JOIN mail_recipients m ON m.operator_id = u.operator_id AND LOWER(m.address) = u.email
         WHERE u.id = $1",
        user
    )?;
    Ok(found.is_some_and(|(listed,)| listed > 0))
}

/// Creates the notifications of published notices.
pub fn create_notifications<'a>(
    tx: &'a mut Tx,
    published: &'a NoticesPublished,
) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move {
        let NoticesPublished {
            tenant,
            notices,
            by,
            at,
        } = published;
        notify(tx, *tenant, notices, *by, *at).await
    })
}
