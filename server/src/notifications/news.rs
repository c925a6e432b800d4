//! Something to be told, on its way to those whom it concerns.
//!
//! What always holds: it is written for each person in the transaction that makes it
//! true, with when a letter is to tell of it; the list and the letters are made from that.

use super::kind::{Kind, Way};
use super::settings::Settings;
use super::store;
use crate::alerts::{AlertChange, Severity};
use crate::db::{Tx, row, rows};
use crate::error::Result;
use crate::ids::{AlertId, OperatorId, OrderId, UserId, VesselId};
use crate::outbox;
use crate::session::Role;
use crate::tenants::Tenant;
use crate::time::Time;

/// Something to be told.
#[derive(Clone, Debug)]
pub struct News {
    /// What it is about.
    pub kind: Kind,
    /// Whether it waits for nothing.
    pub urgent: bool,
    /// In a line.
    pub subject: String,
    /// In a letter: a fact on each line, then sentences.
    pub text: String,
    /// The dashboard's page to look at.
    pub path: String,
    /// The vessel.
    pub vessel: VesselId,
    /// The work order, if it is of one.
    pub order: Option<OrderId>,
    /// The alert, if it is of one.
    pub alert: Option<AlertId>,
}

/// Someone whom news may concern.
struct Person {
    id: UserId,
    role: Role,
    settings: Settings,
}

/// Tells a tenant's people, but not who made the news.
pub async fn tell(
    tx: &mut Tx,
    tenant: impl Into<Tenant>,
    all: &[News],
    by: Option<UserId>,
    now: Time,
) -> Result<()> {
    if all.is_empty() {
        return Ok(());
    }
    for person in people(tx, tenant.into()).await? {
        let concerns = |news: &&News| news.kind.concerns(person.role) && by != Some(person.id);
        for news in all.iter().filter(concerns) {
            let way = person.settings.way(news.kind, person.role);
            if way == Way::Off {
                continue;
            }
            let mut mail_at = person.settings.mail_at(way, news.urgent, now);
            if news.kind == Kind::Alert && is_on_the_mailing_list(tx, person.id).await? {
                mail_at = None;
            }
            store::insert(tx, person.id, news, mail_at, now).await?;
        }
    }
    Ok(())
}

/// Tells an operator's people of what became of alerts.
pub async fn tell_of_alerts(
    tx: &mut Tx,
    operator: OperatorId,
    all: &[AlertChange],
    now: Time,
) -> Result<()> {
    let news: Vec<News> = all.iter().filter_map(of_alert).collect();
    tell(tx, operator, &news, None, now).await
}

fn of_alert(news: &AlertChange) -> Option<News> {
    let alert = &news.alert;
    let critical = alert.severity == Severity::Critical;
    let presses = alert.severity >= Severity::Warning;
    let pressed = news.was.is_some_and(|was| was >= Severity::Warning);
    let told = match news.kind {
        outbox::Kind::AlertRaised | outbox::Kind::AlertCleared => presses,
        // Who was told of it hears once that it presses no more, now or when it is over.
        outbox::Kind::AlertUpdated => critical || presses != pressed,
        _ => false,
    };
    let (subject, text) = crate::mail::words_of(news);
    told.then(|| News {
        kind: Kind::Alert,
        urgent: critical && news.kind != outbox::Kind::AlertCleared,
        subject,
        text,
        path: format!("/vessels/{}", alert.vessel_id),
        vessel: alert.vessel_id,
        order: None,
        alert: Some(alert.id),
    })
}

async fn people(tx: &mut Tx, tenant: Tenant) -> Result<Vec<Person>> {
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

/// Who is on the operator's list gets a letter of each alert by that.
async fn is_on_the_mailing_list(tx: &mut Tx, user: UserId) -> Result<bool> {
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
