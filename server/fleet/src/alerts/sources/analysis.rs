//! Source of alerts: an analysis, in the transaction that stores it.

use super::agent_alerts::reconcile_reports;
use crate::adjustments;
use crate::alerts::after_adjustment::{is_ended_by, remove_earlier_changes};
use crate::alerts::alert::KnownAlert;
use crate::alerts::causes::{
    Facts, OpenCause, Source, UnconfirmedAdjustment, evaluate, evaluate_analysis,
};
use crate::alerts::clearing::ADJUSTED;
use crate::alerts::publish::publish_changes;
use crate::alerts::reconcile::reconcile;
use crate::alerts::store;
use crate::analysis::{self, Findings};
use crate::settings::AlertLimits;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::Event;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;

/// Reconciles a compass's alerts with its last analysis, and with its last adjustment if
/// headings at sea contradict it.
pub async fn reconcile_analysis(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    limits: &AlertLimits,
    unconfirmed: Option<UnconfirmedAdjustment>,
    now: Time,
) -> Result<Option<Event>> {
    store::lock(tx, vessel, compass).await?;
    let Some(findings) = store::findings(tx, vessel, compass).await? else {
        return Ok(None);
    };
    let mut findings: Findings = serde_json::from_str(&findings)?;
    analysis::compare_with_fleet_in(tx, vessel, &mut findings).await?;
    let adjusted = adjustments::last_adjusted_at(tx, vessel, compass).await?;
    if let Some(adjusted) = adjusted {
        remove_earlier_changes(&mut findings, adjusted);
    }
    let known = store::known_of(tx, vessel, compass, Source::Analysis).await?;
    let open = known.iter().map(|alert| OpenCause {
        cause: alert.cause,
        severity: alert.severity,
    });
    let open: Vec<OpenCause> = open.collect();
    let mut desired = evaluate_analysis(&findings, limits, &open);
    if let Some(adjustment) = unconfirmed {
        desired.extend(evaluate(Facts::Verification(&adjustment)));
    }
    let clearing_reason = |alert: &KnownAlert| match adjusted {
        Some(adjusted) if is_ended_by(adjusted, alert.cause, alert.since) => ADJUSTED,
        _ => alert.cause.row().clearing_reason(alert.since, &findings),
    };
    let mut changes =
        reconcile(tx, vessel, compass, &known, &desired, clearing_reason, now).await?;
    let until = findings.data_until;
    changes.extend(reconcile_reports(tx, vessel, compass, until, now).await?);
    publish_changes(tx, vessel, &changes, now).await
}
