//! Verification at sea: settled headings since an adjustment, compared with its prediction.
//!
//! Invariants: a verdict is an entry of the order's log, written in the transaction of its
//! analysis. An alarm is an alert as long as the order has failed. A passed verification is final:
//! a later change of the ship ends the epoch instead.

use crate::work_orders::events::OrderEvent;
use crate::work_orders::log::entry::Author;
use crate::work_orders::payload::sea_verification::SeaVerification;
use crate::work_orders::publish::OrderBefore;
use crate::work_orders::state::State;
use crate::work_orders::{publish, store};
use binnacle_adjustment::adjust::{SettledHeading, Verification, verify};
use binnacle_compass::result::{SampleDiagnostic, SampleReason};
use binnacle_compass::ship::EarthField;
use binnacle_fleet::alerts::UnconfirmedAdjustment;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::events::Event;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use tracing::warn;
use uuid::Uuid;

/// Standard deviation of one heading at sea, degrees: reference, card and sea together.
const HEADING_SD_DEG: f64 = 0.7;

fn agreement_text(headings: usize) -> String {
    if headings == 1 {
        "1 heading agrees".to_owned()
    } else {
        format!("{headings} headings agree")
    }
}

impl SeaVerification {
    fn new(verification: Verification, samples: usize, until: Time) -> SeaVerification {
        let words = match &verification {
            Verification::Passed {
                headings,
                band95_deg,
                rms_deg,
            } => format!(
                "{} with the prediction, to {rms_deg:.1} degrees; the band is now \
                    {band95_deg:.1} degrees",
                agreement_text(*headings)
            ),
            Verification::MoreNeeded { headings, needed } => format!(
                "{} so far; {} more {} needed",
                agreement_text(*headings),
                needed.count,
                if needed.count == 1 { "is" } else { "are" }
            ),
            Verification::Alarm {
                compass_deg,
                off_deg,
                standard_error_deg,
            } => format!(
                "on compass heading {compass_deg:03.0} the deviation is {off_deg:.1} degrees off \
                    the prediction (standard error {standard_error_deg:.1})"
            ),
        };
        SeaVerification {
            verification,
            words,
            samples,
            until,
        }
    }

    /// Returns whether the verdict differs from the last one.
    fn differs_from(&self, last: Option<&SeaVerification>) -> bool {
        let headings = |verified: &SeaVerification| match verified.verification {
            Verification::MoreNeeded { headings, .. } => Some(headings),
            Verification::Passed { .. } | Verification::Alarm { .. } => None,
        };
        last.is_none_or(|last| {
            headings(last) != headings(self)
                || std::mem::discriminant(&last.verification)
                    != std::mem::discriminant(&self.verification)
        })
    }
}

/// Returns the time of a compass's last adjustment, if headings at sea are still awaited.
pub async fn awaited_since(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<Time>> {
    let last = store::find_last_completed(tx, vessel, compass).await?;
    Ok(last
        .filter(|(_, state, _)| *state == State::Adjusted)
        .map(|(_, _, completed_at)| completed_at))
}

/// Compares a compass's samples since its last adjustment with the prediction.
pub async fn after_analysis(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
    samples: &[SampleDiagnostic],
    now: Time,
) -> Result<Vec<Event>> {
    let last = store::find_last_completed(tx, vessel, compass).await?;
    let Some((order, State::Adjusted, _)) = last else {
        return Ok(Vec::new());
    };
    let mut stored = store::lock(tx, vessel, order).await?;
    let state = stored.state();
    let before = OrderBefore::from_order(&stored);
    let Some(completed) = state.completion else {
        return Ok(Vec::new());
    };
    let counts = |found: &&SampleDiagnostic| {
        Time(found.sample.time) > completed.at
            && matches!(found.reason, None | Some(SampleReason::NoModel))
    };
    let counted: Vec<&SampleDiagnostic> = samples.iter().filter(counts).collect();
    let settled: Vec<SettledHeading> = counted
        .iter()
        .filter_map(|found| settled_heading(found))
        .collect();
    let (Some(last), Some(here)) = (counted.last(), settled.last().map(|last| last.earth)) else {
        return Ok(Vec::new());
    };
    let verification = match verify(&completed.model_after, &settled, here) {
        Ok(verification) => verification,
        Err(error) => {
            warn!(%vessel, %error, "an adjustment cannot be verified");
            return Ok(Vec::new());
        }
    };
    let verified = SeaVerification::new(verification, settled.len(), Time(last.sample.time));
    if !verified.differs_from(state.verification.as_ref()) {
        return Ok(Vec::new());
    }
    if matches!(verified.verification, Verification::Passed { .. }) {
        let text = serde_json::to_string(&verified)?;
        store::store_verification(tx, &stored.summary, now, &text).await?;
    }
    let author = Author::server();
    let content = OrderEvent::Verification(Box::new(verified));
    store::append(tx, &mut stored, Uuid::now_v7(), &author, now, content).await?;
    publish::publish_changes(tx, &stored, &before, now).await
}

fn settled_heading(found: &SampleDiagnostic) -> Option<SettledHeading> {
    Some(SettledHeading {
        compass: found.sample.compass,
        deviation_deg: found.deviation_deg?,
        sd_deg: HEADING_SD_DEG,
        earth: EarthField {
            h_nt: found.h_nt?,
            z_nt: found.z_nt?,
        },
    })
}

/// Returns a compass's last adjustment, if headings at sea contradict it.
pub async fn unconfirmed_adjustment(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<UnconfirmedAdjustment>> {
    let last = store::find_last_completed(tx, vessel, compass).await?;
    let Some((order, State::Failed, adjusted_at)) = last else {
        return Ok(None);
    };
    let stored = store::lock(tx, vessel, order).await?;
    let verified = stored.state().verification;
    Ok(verified.map(|verified| UnconfirmedAdjustment {
        order,
        adjusted_at,
        verdict: verified.words,
        samples: verified.samples,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_adjustment::adjust::NeededHeadings;
    use binnacle_compass::time::Timestamp;

    #[test]
    fn one_heading_agrees_and_several_agree() {
        let words = |headings, count| {
            let needed = NeededHeadings {
                count,
                compass_deg: Vec::new(),
            };
            let so_far = Verification::MoreNeeded { headings, needed };
            let until = Timestamp::parse("2026-11-21T12:00:00Z").unwrap();
            SeaVerification::new(so_far, headings, until.into()).words
        };
        assert_eq!(words(1, 4), "1 heading agrees so far; 4 more are needed");
        assert_eq!(words(4, 1), "4 headings agree so far; 1 more is needed");
    }
}
