//! Which news of an alert becomes a letter, and to whom.

use super::letter::Letter;
use super::store;
use crate::alerts::{Alert, AlertChange, Severity};
use crate::db::Tx;
use crate::error::Result;
use crate::ids::{OperatorId, RecipientId};
use crate::outbox::{self, Kind, Message};
use crate::time::Time;

/// Queues letters about alerts for those of an operator's recipients who want them.
pub async fn announce(
    tx: &mut Tx,
    operator: OperatorId,
    all: &[AlertChange],
    now: Time,
) -> Result<()> {
    for (recipient, least) in store::wishes(tx, operator).await? {
        for news in all {
            let is_news = note(tx, recipient, least, news).await?;
            if is_news && !is_replaced(news, least, all) {
                let message = Message {
                    id: news.id,
                    kind: news.kind,
                    order: None,
                    body: serde_json::to_string(&Letter::of(news))?,
                };
                outbox::queue(tx, recipient.0, &message, now).await?;
            }
        }
    }
    Ok(())
}

/// Whether a letter of the next alert of the cause goes to the same recipient: it says more
/// than that this one is over.
fn is_replaced(news: &AlertChange, least: Severity, all: &[AlertChange]) -> bool {
    let of = |alert: &Alert| (alert.compass_id, alert.cause);
    let is_next = |other: &AlertChange| {
        other.kind == Kind::AlertRaised
            && other.alert.severity >= least
            && of(&other.alert) == of(&news.alert)
    };
    news.kind == Kind::AlertCleared && all.iter().any(is_next)
}

/// Whether a recipient is told this, which is then noted.
async fn note(
    tx: &mut Tx,
    recipient: RecipientId,
    least: Severity,
    news: &AlertChange,
) -> Result<bool> {
    let alert = news.alert.id;
    let told = store::told(tx, recipient, alert).await?;
    match news.kind {
        Kind::AlertRaised | Kind::AlertUpdated => {
            let severity = news.alert.severity;
            if severity < least {
                // For this recipient that is its end.
                store::forget(tx, recipient, alert).await?;
                return Ok(told.is_some());
            }
            if told.is_some_and(|told| severity <= told) {
                return Ok(false);
            }
            store::tell(tx, recipient, alert, severity).await?;
            Ok(true)
        }
        Kind::AlertCleared => {
            store::forget(tx, recipient, alert).await?;
            Ok(told.is_some())
        }
        _ => Ok(false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alerts::{Cause, Evidence, State};
    use crate::ids::{AlertId, CompassId, DeliveryId, VesselId};
    use binnacle_magnetics::time::Timestamp;

    fn news(kind: Kind, compass: CompassId, severity: Severity) -> AlertChange {
        let at = Time(Timestamp::parse("2026-11-21T07:00:00Z").unwrap());
        AlertChange {
            id: DeliveryId::new(),
            kind,
            alert: Alert {
                id: AlertId::new(),
                vessel_id: VesselId::new(),
                vessel_name: "Nao".to_owned(),
                compass_id: compass,
                compass_name: "Standard compass".to_owned(),
                cause: Cause::LightningOrShock,
                severity,
                state: State::Raised,
                since: at,
                summary: String::new(),
                advice: String::new(),
                evidence: Evidence(Vec::new()),
                raised_at: at,
                updated_at: at,
                acknowledged_at: None,
                acknowledged_by: None,
                acknowledgement_note: None,
                cleared_at: None,
                cleared_by: None,
                clearing_reason: None,
            },
            was: None,
        }
    }

    #[test]
    fn an_end_is_told_where_the_alert_that_follows_it_is_not() {
        let compass = CompassId::new();
        let over = news(Kind::AlertCleared, compass, Severity::Critical);
        let next = news(Kind::AlertRaised, compass, Severity::Notice);
        let all = [over.clone(), next];
        assert!(is_replaced(&over, Severity::Notice, &all));
        assert!(!is_replaced(&over, Severity::Critical, &all));
        let elsewhere = news(Kind::AlertRaised, CompassId::new(), Severity::Critical);
        assert!(!is_replaced(
            &over,
            Severity::Notice,
            &[over.clone(), elsewhere]
        ));
    }
}
