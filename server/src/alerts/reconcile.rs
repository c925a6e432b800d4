//! Brings a compass's alerts in line with what ought to be open, and tells of what
//! is new.
//!
//! What always holds: whoever changes a compass's alerts holds its lock until the
//! transaction ends, and every change of an alert is told in that transaction. An alert
//! is about one event: another of its cause is another alert, whatever people said of
//! the first.

use super::after_adjustment::{ADJUSTED, forget_changes, is_about_before};
use super::alert::{Alert, Cause, DesiredAlert, Severity, State};
use super::change_rules::{Became, became};
use super::limits::AlertLimits;
use super::rules::{find_desired, silence};
use super::store::{self, KnownAlert};
use super::{agent_alerts, duplicate_agent};
use crate::analysis::{self, Findings};
use crate::app::App;
use crate::db::Tx;
use crate::error::Result;
use crate::events::{self, Event};
use crate::ids::{AlertId, CompassId, DeliveryId, VesselId};
use crate::outbox::Kind;
use crate::time::Time;
use crate::{compasses, mail, notifications, vessels, webhooks, work_orders};
use std::time::Duration;
use tracing::{error, info};

/// How often to look for what time alone brings.
const LOOK_EVERY: Duration = Duration::from_mins(1);
/// Why an alert cleared itself.
pub(super) const OVER: &str = "it is over";
const NOT_KNOWN: &str = "there is no model any more that could tell whether it still is so: it is \
                         not known to be over";
const WITHDRAWN: &str = "it is withdrawn: the samples since do not bear out that anything changed";
const LEARNT: &str = "the model has learnt it: the deviation stays as it is now, and no card from \
                      before it holds";
const RENAMED: &str = "something else is held to be its cause now, and has an alert of its own";
const NO_SERVICE: &str = "the vessel is out of service";
const FOLLOWED: &str = "another of its cause followed";

/// A change of an alert: what became of it, or only other words.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingChange {
    pub(super) alert: AlertId,
    pub(super) became: Option<Kind>,
    /// How bad it was before, where that is another severity.
    pub(super) was: Option<Severity>,
}

/// What became of an alert, and how it stands then.
#[derive(Clone, Debug)]
pub struct AlertChange {
    /// The event's id.
    pub id: DeliveryId,
    /// What became of it.
    pub kind: Kind,
    /// The alert.
    pub alert: Alert,
    /// How bad it was before, where that is another severity.
    pub was: Option<Severity>,
}

/// Holds a compass's alerts against its last analysis.
pub async fn reconcile_analysis(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    limits: &AlertLimits,
    now: Time,
) -> Result<Option<Event>> {
    store::lock(tx, vessel, compass).await?;
    let Some(findings) = store::findings(tx, vessel, compass).await? else {
        return Ok(None);
    };
    let mut findings: Findings = serde_json::from_str(&findings)?;
    analysis::sharpen_in(tx, vessel, &mut findings).await?;
    let adjusted = work_orders::adjusted_at(tx, vessel, compass).await?;
    if let Some(adjusted) = adjusted {
        forget_changes(&mut findings, adjusted);
    }
    let mut known = store::known(tx, vessel, compass).await?;
    known.retain(|alert| alert.cause.is_of_an_analysis());
    let open = known.iter().map(|alert| (alert.cause, alert.severity));
    let open: Vec<(Cause, Severity)> = open.collect();
    let mut wanted = find_desired(&findings, limits, &open);
    wanted.extend(work_orders::alert(tx, vessel, compass).await?);
    let why = |alert: &KnownAlert| match adjusted {
        Some(adjusted) if is_about_before(alert.cause, alert.since, adjusted) => ADJUSTED,
        _ => why_cleared(alert, &findings),
    };
    let mut news = reconcile(tx, vessel, compass, &known, &wanted, why, now).await?;
    news.extend(agent_alerts::in_line(tx, vessel, compass, findings.data_until, now).await?);
    publish_changes(tx, vessel, &news, now).await
}

/// What clears an alert that an analysis calls for no more. Without a model nothing is
/// known of what the compass shows.
fn why_cleared(alert: &KnownAlert, findings: &Findings) -> &'static str {
    match became(alert.cause, alert.since, findings) {
        Some(Became::Withdrawn) => return WITHDRAWN,
        Some(Became::Learnt) => return LEARNT,
        Some(Became::Renamed) if alert.cause.is_dated_anew() => return RENAMED,
        Some(Became::Renamed) | None => {}
    }
    match alert.cause {
        Cause::DeviationOverLimit if findings.worst.is_none() => NOT_KNOWN,
        Cause::WideBand if findings.widest_band95_deg.is_none() => NOT_KNOWN,
        _ => OVER,
    }
}

/// Ends all alerts of a vessel that goes out of service.
///
/// # Errors
/// When the database cannot be asked.
pub async fn end_all(tx: &mut Tx, vessel: VesselId, now: Time) -> Result<Vec<Event>> {
    let mut events = Vec::new();
    for compass in compasses::ids(tx, vessel).await? {
        store::lock(tx, vessel, compass).await?;
        let known = store::known(tx, vessel, compass).await?;
        let news = reconcile(tx, vessel, compass, &known, &[], |_| OVER, now).await?;
        events.extend(publish_changes(tx, vessel, &news, now).await?);
    }
    Ok(events)
}

/// Looks which agents have fallen silent, and which have not.
///
/// # Errors
/// When the database cannot be asked.
pub async fn check_silence(app: &App) -> Result<()> {
    let now: Time = app.clock.now().into();
    for heard in store::heard(&app.db).await? {
        let limits = match &heard.limits {
            Some(text) => serde_json::from_str(text)?,
            None => AlertLimits::default(),
        };
        let wanted = silence(heard.last_at, &limits, now);
        if wanted.is_some() == (heard.alerts > 0) {
            continue;
        }
        let (vessel, compass) = (heard.vessel_id, heard.compass_id);
        let mut tx = app.db.begin().await?;
        store::lock(&mut tx, vessel, compass).await?;
        let mut known = store::known(&mut tx, vessel, compass).await?;
        known.retain(|alert| alert.cause.is_of_the_clock());
        let wanted: Vec<DesiredAlert> = wanted.into_iter().collect();
        let news = reconcile(&mut tx, vessel, compass, &known, &wanted, |_| OVER, now).await?;
        let event = publish_changes(&mut tx, vessel, &news, now).await?;
        tx.commit().await?;
        if let Some(event) = event {
            app.publish(event);
        }
    }
    Ok(())
}

/// Looks for what time alone brings.
///
/// # Errors
/// When the database cannot be asked.
pub async fn check_timed(app: &App) -> Result<()> {
    check_silence(app).await?;
    agent_alerts::look(app).await?;
    duplicate_agent::look(app).await
}

/// Looks after alerts of the clock until the server stops.
pub async fn watch(app: App) {
    while !app.stopping.is_cancelled() {
        if let Err(error) = check_timed(&app).await {
            error!(?error, "alerts of the clock cannot be looked for");
        }
        tokio::select! {
            () = app.stopping.cancelled() => {}
            () = tokio::time::sleep(LOOK_EVERY) => {}
        }
    }
}

pub(super) async fn reconcile(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    known: &[KnownAlert],
    wanted: &[DesiredAlert],
    why_cleared: impl Fn(&KnownAlert) -> &'static str,
    now: Time,
) -> Result<Vec<PendingChange>> {
    let in_service = vessels::is_in_service(tx, vessel).await?;
    let wanted = if in_service { wanted } else { &[] };
    let mut news = Vec::new();
    for alert in known {
        if wanted.iter().any(|wanted| wanted.cause == alert.cause) {
            continue;
        }
        let why = if in_service {
            why_cleared(alert)
        } else {
            NO_SERVICE
        };
        store::end(tx, vessel, alert.id, why, now).await?;
        if alert.state != State::Cleared {
            news.push(PendingChange::of(alert.id, Kind::AlertCleared));
        }
    }
    for wanted in wanted {
        let known = known.iter().find(|alert| alert.cause == wanted.cause);
        news.extend(open_or_update(tx, vessel, compass, known, wanted, now).await?);
    }
    Ok(news)
}

async fn open_or_update(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    known: Option<&KnownAlert>,
    wanted: &DesiredAlert,
    now: Time,
) -> Result<Vec<PendingChange>> {
    let raised = |alert| PendingChange::of(alert, Kind::AlertRaised);
    let Some(known) = known else {
        let id = store::insert(tx, vessel, compass, wanted, now).await?;
        return Ok(vec![raised(id)]);
    };
    let worse = wanted.severity > known.severity;
    let is_another = !wanted.window.includes(known.since);
    let is_cleared = known.state == State::Cleared;
    if is_another || (is_cleared && worse) {
        store::end(tx, vessel, known.id, FOLLOWED, now).await?;
        let cleared = (!is_cleared).then(|| PendingChange::of(known.id, Kind::AlertCleared));
        let id = store::insert(tx, vessel, compass, wanted, now).await?;
        return Ok(cleared.into_iter().chain([raised(id)]).collect());
    }
    if is_cleared || known.says(wanted) {
        return Ok(Vec::new());
    }
    store::update(tx, vessel, known, wanted, now).await?;
    let became = match known.state {
        _ if wanted.severity == known.severity => None,
        State::Acknowledged if worse => Some(Kind::AlertRaised),
        _ => Some(Kind::AlertUpdated),
    };
    Ok(vec![PendingChange {
        alert: known.id,
        became,
        was: (wanted.severity != known.severity).then_some(known.severity),
    }])
}

/// Tells dashboards, within the transaction, and whoever else wants to know.
pub(super) async fn publish_changes(
    tx: &mut Tx,
    vessel: VesselId,
    news: &[PendingChange],
    now: Time,
) -> Result<Option<Event>> {
    if news.is_empty() {
        return Ok(None);
    }
    let mut told = Vec::new();
    for news in news {
        let PendingChange { alert, was, .. } = news;
        let Some(kind) = news.became else {
            continue;
        };
        info!(%vessel, %alert, ?kind, "an alert changed");
        told.push(AlertChange {
            id: DeliveryId::new(),
            kind,
            alert: store::read(tx, vessel, *alert).await?,
            was: *was,
        });
    }
    let event = events::insert(tx, vessel, events::Kind::Alert, now).await?;
    webhooks::announce(tx, event.operator_id, &told, now).await?;
    mail::announce(tx, event.operator_id, &told, now).await?;
    notifications::tell_of_alerts(tx, event.operator_id, &told, now).await?;
    Ok(Some(event))
}

impl PendingChange {
    pub(super) fn of(alert: AlertId, became: Kind) -> PendingChange {
        PendingChange {
            alert,
            became: Some(became),
            was: None,
        }
    }
}

impl KnownAlert {
    fn says(&self, wanted: &DesiredAlert) -> bool {
        (
            self.severity,
            &self.summary,
            self.advice.as_str(),
            &self.evidence,
        ) == (
            wanted.severity,
            &wanted.summary,
            wanted.advice,
            &wanted.evidence,
        )
    }
}

/// The worst of some severities, with how many alerts nobody has acknowledged.
pub fn summarize<'a>(
    standing: impl Iterator<Item = &'a store::OpenCount>,
) -> (u32, Option<Severity>) {
    let (mut raised, mut worst) = (0, None);
    for of_a_kind in standing {
        worst = worst.max(Some(of_a_kind.severity));
        if of_a_kind.state == State::Raised {
            raised += of_a_kind.alerts as u32;
        }
    }
    (raised, worst)
}
