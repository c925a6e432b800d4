//! Notifications of compasses that are due soon, or sooner than before.
//!
//! Invariants: each step towards the due date is notified once, by the first process that finds
//! it. A postponed date is recorded without a notification. Calendars show the recorded needs.

use super::create::notify;
use super::store::{self, RecordedNeed};
use crate::needs::{Need, find_need, load_facts, store_deviation_histories};
use crate::schedule_settings;
use binnacle_fleet::{event_kinds, operators};
use binnacle_platform::app::App;
use binnacle_platform::error::Result;
use binnacle_platform::events;
use binnacle_platform::ids::{CompassId, OperatorId};
use binnacle_platform::notices::{DeclaredKind, DefaultMail, Notice, Readers};
use binnacle_platform::time::Time;
use binnacle_schedule::needs::{CauseKind, Urgency};
use chrono::NaiveDate;
use serde_json::Value;
use std::collections::BTreeMap;
use tracing::error;

/// A compass needs adjustment soon or very soon, or is overdue.
const DUE_SOON: DeclaredKind =
    DeclaredKind::new("due_soon", Readers::Operators, DefaultMail::Digest);
/// A due date was brought forward.
const NEED_RAISED: DeclaredKind =
    DeclaredKind::new("need_raised", Readers::Operators, DefaultMail::Letter);

/// Kinds of notices about needs, in the order in which the API lists them.
pub const NOTICE_KINDS: [DeclaredKind; 2] = [DUE_SOON, NEED_RAISED];

/// Days that a due date must move forward for a notification: predictions shift it by a few days.
const BROUGHT_FORWARD_DAYS: i64 = 7;

/// Creates the notifications of all fleets' needs and returns their number. A fleet that fails
/// does not hold up the others.
pub async fn notify_of_needs(app: &App) -> Result<usize> {
    let mut notified = 0;
    for operator in operators::all(&app.db).await? {
        match notify_operator(app, operator).await {
            Ok(more) => notified += more,
            Err(error) => error!(?error, %operator, "cannot check a fleet's needs"),
        }
    }
    Ok(notified)
}

async fn notify_operator(app: &App, operator: OperatorId) -> Result<usize> {
    let now: Time = app.clock.now().into();
    let today = now.0.to_chrono().date_naive();
    let mut before: BTreeMap<CompassId, RecordedNeed> =
        store::list_recorded_needs(&app.db, operator)
            .await?
            .into_iter()
            .map(|recorded| (recorded.compass_id, recorded))
            .collect();
    // The records are read first, so that those of another process since then are not deleted.
    let facts = load_facts(app, operator, None).await?;
    store_deviation_histories(app, &facts).await?;
    let terms = schedule_settings::terms(&app.db, operator).await?;
    let needs = facts
        .iter()
        .filter_map(|facts| find_need(facts, &terms, today));
    let mut notified = 0;
    for need in needs {
        let known = before.remove(&need.compass_id);
        let current = to_record(&need)?;
        if known.as_ref() == Some(&current) {
            continue;
        }
        let mut tx = app.db.begin().await?;
        if !store::record_need(&mut tx, known.as_ref(), &current, now).await? {
            continue;
        }
        let mut event = None;
        if let Some(kind) = choose_kind(&need, known.as_ref())? {
            notify(&mut tx, operator, &[write_notice(&need, kind)], None, now).await?;
            event = Some(events::insert(&mut tx, need.vessel_id, event_kinds::NEED, now).await?);
            notified += 1;
        }
        tx.commit().await?;
        if let Some(event) = event {
            app.publish(event);
        }
    }
    for (_, ended) in before {
        let mut tx = app.db.begin().await?;
        store::delete_recorded_need(&mut tx, &ended).await?;
        tx.commit().await?;
    }
    Ok(notified)
}

/// Returns the record of a need.
fn to_record(need: &Need) -> Result<RecordedNeed> {
    Ok(RecordedNeed {
        vessel_id: need.vessel_id,
        compass_id: need.compass_id,
        due_on: need.due_on.to_string(),
        urgency: urgency_name(need.urgency)?,
        reason: need.reason.clone(),
    })
}

/// Returns the kind of notification that a need calls for, if any, given its last record.
fn choose_kind(need: &Need, known: Option<&RecordedNeed>) -> Result<Option<DeclaredKind>> {
    let is_pressing = need.urgency >= Urgency::Soon;
    let Some(known) = known else {
        return Ok(is_pressing.then_some(DUE_SOON));
    };
    let urgency: Urgency = serde_json::from_value(Value::String(known.urgency.clone()))?;
    let due_on: NaiveDate = known.due_on.parse().map_err(anyhow::Error::from)?;
    let is_earlier = (due_on - need.due_on).num_days() > BROUGHT_FORWARD_DAYS;
    let cause = need.causes.first().map(|cause| cause.kind);
    if is_earlier && !matches!(cause, Some(CauseKind::Interval | CauseKind::NeverAdjusted)) {
        return Ok(Some(NEED_RAISED));
    }
    Ok((is_pressing && need.urgency > urgency).then_some(DUE_SOON))
}

fn write_notice(need: &Need, kind: DeclaredKind) -> Notice {
    let status = match (kind, need.urgency) {
        (NEED_RAISED, _) => "due for adjustment sooner",
        (_, Urgency::Overdue) => "overdue for adjustment",
        _ => "due for adjustment soon",
    };
    let adjusted = need.adjusted_on.map(|day| day.to_string());
    let adjusted = adjusted.unwrap_or_else(|| "not on record".to_owned());
    Notice {
        kind,
        urgent: false,
        subject: format!(
            "{}: {} {status}, by {}",
            need.vessel_name, need.compass_name, need.due_on
        ),
        text: format!(
            "Vessel:   {}\nCompass:  {}\nDue:      {}\nAdjusted: {adjusted}\n\n{}.\n",
            need.vessel_name, need.compass_name, need.due_on, need.reason
        ),
        path: format!("/vessels/{}", need.vessel_id),
        vessel: Some(need.vessel_id),
        about: None,
    }
}

fn urgency_name(urgency: Urgency) -> Result<String> {
    let name = serde_json::to_value(urgency)?;
    Ok(name.as_str().unwrap_or_default().to_owned())
}
