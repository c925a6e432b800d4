//! Telling an operator's people of compasses that are due soon, or sooner than they were.
//!
//! What always holds: each step towards the due date is told once, by whichever process
//! sees it first; a date that is put off is noted and not told. What is noted is what
//! calendars show.

use super::create::tell;
use super::store::{self, Noted};
use crate::needs::{Need, find_need, load_facts, store_deviation_histories};
use crate::schedule_settings;
use binnacle_fleet::operators;
use binnacle_platform::app::App;
use binnacle_platform::error::Result;
use binnacle_platform::events;
use binnacle_platform::ids::{CompassId, OperatorId};
use binnacle_platform::notices::Kind;
use binnacle_platform::notices::Notice;
use binnacle_platform::time::Time;
use binnacle_schedule::needs::{CauseKind, Urgency};
use chrono::NaiveDate;
use serde_json::Value;
use std::collections::BTreeMap;
use tracing::error;

/// Predictions move a due date by a few days each time: that is no news.
const BROUGHT_FORWARD_DAYS: i64 = 7;

/// Looks through all fleets; how many needs were told of. One that cannot be looked through
/// holds up no other.
pub async fn look(app: &App) -> Result<usize> {
    let mut told = 0;
    for operator in operators::all(&app.db).await? {
        match look_at(app, operator).await {
            Ok(more) => told += more,
            Err(error) => error!(?error, %operator, "a fleet's needs cannot be looked for"),
        }
    }
    Ok(told)
}

async fn look_at(app: &App, operator: OperatorId) -> Result<usize> {
    let now: Time = app.clock.now().into();
    let today = now.0.to_chrono().date_naive();
    let mut before: BTreeMap<CompassId, Noted> = store::needs_told(&app.db, operator)
        .await?
        .into_iter()
        .map(|noted| (noted.compass_id, noted))
        .collect();
    // What was noted is read first: what another process notes meanwhile is not forgotten.
    let facts = load_facts(app, operator, None).await?;
    store_deviation_histories(app, &facts).await?;
    let terms = schedule_settings::terms(&app.db, operator).await?;
    let needs = facts
        .iter()
        .filter_map(|facts| find_need(facts, &terms, today));
    let mut told = 0;
    for need in needs {
        let known = before.remove(&need.compass_id);
        let stands = noted(&need)?;
        if known.as_ref() == Some(&stands) {
            continue;
        }
        let mut tx = app.db.begin().await?;
        if !store::note_need(&mut tx, known.as_ref(), &stands, now).await? {
            continue;
        }
        let mut event = None;
        if let Some(kind) = kind(&need, known.as_ref())? {
            tell(&mut tx, operator, &[news(&need, kind)], None, now).await?;
            event = Some(events::insert(&mut tx, need.vessel_id, events::Kind::Need, now).await?);
            told += 1;
        }
        tx.commit().await?;
        if let Some(event) = event {
            app.publish(event);
        }
    }
    for (_, gone) in before {
        let mut tx = app.db.begin().await?;
        store::forget_need(&mut tx, &gone).await?;
        tx.commit().await?;
    }
    Ok(told)
}

/// Returns the state of a need for the record.
fn noted(need: &Need) -> Result<Noted> {
    Ok(Noted {
        vessel_id: need.vessel_id,
        compass_id: need.compass_id,
        due_on: need.due_on.to_string(),
        urgency: word(need.urgency)?,
        reason: need.reason.clone(),
    })
}

/// Returns the kind of notification that a need calls for, if any, given its last record.
fn kind(need: &Need, known: Option<&Noted>) -> Result<Option<Kind>> {
    let presses = need.urgency > Urgency::Routine;
    let Some(known) = known else {
        return Ok(presses.then_some(Kind::DueSoon));
    };
    let urgency: Urgency = serde_json::from_value(Value::String(known.urgency.clone()))?;
    let due_on: NaiveDate = known.due_on.parse().map_err(anyhow::Error::from)?;
    let earlier = (due_on - need.due_on).num_days() > BROUGHT_FORWARD_DAYS;
    let by = need.causes.first().map(|cause| cause.kind);
    if earlier && !matches!(by, Some(CauseKind::Interval | CauseKind::NeverAdjusted)) {
        return Ok(Some(Kind::NeedRaised));
    }
    Ok((presses && need.urgency > urgency).then_some(Kind::DueSoon))
}

fn news(need: &Need, kind: Kind) -> Notice {
    let what = match (kind, need.urgency) {
        (Kind::NeedRaised, _) => "to be adjusted sooner",
        (_, Urgency::Overdue) => "overdue for adjusting",
        _ => "to be adjusted soon",
    };
    let adjusted = need.adjusted_on.map(|day| day.to_string());
    let adjusted = adjusted.unwrap_or_else(|| "not on record".to_owned());
    Notice {
        kind,
        urgent: false,
        subject: format!(
            "{}: {} {what}, by {}",
            need.vessel_name, need.compass_name, need.due_on
        ),
        text: format!(
            "Vessel:   {}\nCompass:  {}\nDue:      {}\nAdjusted: {adjusted}\n\n{}.\n",
            need.vessel_name, need.compass_name, need.due_on, need.reason
        ),
        path: format!("/vessels/{}", need.vessel_id),
        vessel: need.vessel_id,
        order: None,
        alert: None,
    }
}

fn word(urgency: Urgency) -> Result<String> {
    let word = serde_json::to_value(urgency)?;
    Ok(word.as_str().unwrap_or_default().to_owned())
}
