//! Notice to an operator's admins when many sign-ins with their people's accounts are refused.

use crate::app::App;
use crate::db::{self, Db, Tx, execute, rows};
use crate::error::Result;
use crate::ids::OperatorId;
use crate::notices::{DeclaredKind, DefaultMail, Notice, NoticesPublished, Readers};
use crate::tenants::Tenant;
use crate::time::Time;
use binnacle_compass::time::Timestamp;
use std::time::Duration;
use tracing::{error, warn};

/// Kind of notice: many refused sign-ins.
pub const NOTICE_KIND: DeclaredKind =
    DeclaredKind::new("sign_ins_refused", Readers::Admins, DefaultMail::Letter);

/// Refusals within [`WITHIN_S`] that are many. A person who has forgotten a password makes a
/// handful; twenty are more than one person tries before the waits of the throttle.
const MANY: i64 = 20;
/// Period in which refusals are counted, seconds.
const WITHIN_S: f64 = 3600.0;
/// Time until the same operator is notified again, seconds.
const NOTIFIED_AGAIN_AFTER_S: f64 = 86_400.0;
/// Interval between two looks at the audit log.
const LOOK_EVERY: Duration = Duration::from_mins(1);
/// Accounts and addresses that a notice names at most.
const MOST_NAMED: i64 = 5;

/// Notifies the admins of each operator with many refusals in the last hour, once a day. Returns the
/// number of operators.
///
/// # Errors
/// Fails when the database fails.
pub async fn notify_of_many(app: &App) -> Result<usize> {
    let now = app.clock.now();
    let since = Time(now.plus_seconds(-WITHIN_S));
    let notified_before = Time(now.plus_seconds(-NOTIFIED_AGAIN_AFTER_S));
    let attacked = list_attacked(&app.db, since, notified_before).await?;
    let mut notified = 0;
    for (operator, refusals) in attacked {
        // One operator's notice that fails must not keep it from the others.
        match notify(app, operator, refusals, now).await {
            Ok(true) => notified += 1,
            Ok(false) => {}
            Err(error) => {
                error!(?error, %operator, "admins cannot be notified of refused sign-ins");
            }
        }
    }
    Ok(notified)
}

/// Notifies an operator's admins; false if another process has done it.
async fn notify(app: &App, operator: OperatorId, refusals: i64, now: Timestamp) -> Result<bool> {
    let since = Time(now.plus_seconds(-WITHIN_S));
    let notified_before = Time(now.plus_seconds(-NOTIFIED_AGAIN_AFTER_S));
    let mut tx = app.db.begin().await?;
    if !note_notified(&mut tx, operator, notified_before, now.into()).await? {
        return Ok(false);
    }
    let accounts = most_tried(&mut tx, operator, since).await?;
    let notice = notice(refusals, &accounts);
    tx.publish(&NoticesPublished {
        tenant: Tenant::Operator(operator),
        notices: vec![notice],
        by: None,
        at: now.into(),
    })
    .await?;
    tx.commit().await?;
    warn!(%operator, refusals, "many sign-ins are refused");
    Ok(true)
}

/// Looks for many refusals until the server stops.
pub async fn watch(app: App) {
    while !app.stopping.is_cancelled() {
        if let Err(error) = notify_of_many(&app).await {
            error!(?error, "refused sign-ins cannot be counted");
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(LOOK_EVERY) => {}
        }
    }
}

fn notice(refusals: i64, tried: &[(String, String, i64)]) -> Notice {
    let tried: Vec<String> = tried
        .iter()
        .map(|(account, address, times)| format!("{account} from {address}: {times} times"))
        .collect();
    Notice {
        kind: NOTICE_KIND,
        urgent: true,
        subject: format!("{refusals} sign-ins were refused within an hour"),
        text: format!(
            "{}\n\nSomebody may be guessing passwords. A browser in which a user signed in before \
             is not locked out by it. Require a second factor of everyone if you do not yet, and look at the refused \
             sign-ins in the audit log.",
            tried.join("\n")
        ),
        path: "/settings/audit".to_owned(),
        vessel: None,
        about: None,
    }
}

async fn list_attacked(
    db: &Db,
    since: Time,
    notified_before: Time,
) -> db::Result<Vec<(OperatorId, i64)>> {
    rows!(
        db,
        (OperatorId, i64),
        "SELECT l.operator_id, COUNT(*) FROM audit_lines l
         JOIN operators o ON o.id = l.operator_id
         WHERE l.refusal IS NOT NULL AND l.at >= $1
           AND (o.refusals_notified_at IS NULL OR o.refusals_notified_at < $2)
         GROUP BY l.operator_id
         HAVING COUNT(*) >= $3
         ORDER BY l.operator_id",
        since,
        notified_before,
        MANY
    )
}

/// Records that an operator is notified now; false if another process has done it.
async fn note_notified(
    tx: &mut Tx,
    operator: OperatorId,
    notified_before: Time,
    now: Time,
) -> db::Result<bool> {
    let noted = execute!(
        tx,
        "UPDATE operators SET refusals_notified_at = $2
         WHERE id = $1 AND (refusals_notified_at IS NULL OR refusals_notified_at < $3)",
        operator,
        now,
        notified_before
    )?;
    Ok(noted > 0)
}

/// Returns the accounts and addresses with the most refusals.
async fn most_tried(
    tx: &mut Tx,
    operator: OperatorId,
    since: Time,
) -> db::Result<Vec<(String, String, i64)>> {
    rows!(
        in tx,
        (String, String, i64),
        "SELECT COALESCE(account, actor_name), address, COUNT(*) FROM audit_lines
         WHERE operator_id = $1 AND refusal IS NOT NULL AND at >= $2
         GROUP BY COALESCE(account, actor_name), address
         ORDER BY COUNT(*) DESC, COALESCE(account, actor_name), address
         LIMIT $3",
        operator,
        since,
        MOST_NAMED
    )
}
