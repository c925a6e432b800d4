//! Reported work on the vessel or its compass ends the card on board at once, with or without a
//! link.
//!
//! Invariant: the card is not used from the time the work began until the server has a later model,
//! or has refused or superseded the report.

use crate::spool::{ReportState, StoredReport};
use binnacle_compass::time::Timestamp;
use binnacle_wire::messages::{CardWithdrawn, ModelDownlink};
use serde_json::Value;

const DAY_S: f64 = 86_400.0;
/// Age of work, before the model's last sample, above which the model contains it.
const KNOWN_TO_MODEL_S: f64 = 30.0 * DAY_S;
/// Tolerance between the start of an epoch and that of the work: the server dates epochs by the
/// samples.
const DATING_TOLERANCE_S: f64 = DAY_S;

/// Returns the withdrawal by the latest work that ends the card.
pub(crate) fn find_invalidation(
    model: &ModelDownlink,
    reports: &[StoredReport],
    now: Timestamp,
) -> Option<CardWithdrawn> {
    let invalidating = reports
        .iter()
        .filter(|stored| invalidates(model, stored, now));
    let last = invalidating.max_by_key(|stored| stored.sent.report.from)?;
    let report = &last.sent.report;
    let reason = match serde_json::to_value(report.kind) {
        Ok(Value::String(word)) => word,
        _ => "work".to_owned(),
    };
    Some(CardWithdrawn {
        since: report.from,
        reason,
    })
}

fn invalidates(model: &ModelDownlink, stored: &StoredReport, now: Timestamp) -> bool {
    let report = &stored.sent.report;
    let from = report.from;
    let is_effective = report.kind.ends_an_epoch() && !stored.is_withdrawn() && from <= now;
    let is_known = model.data_until.seconds_since(from) > KNOWN_TO_MODEL_S;
    let replaces = model.replaces.as_ref();
    let is_replaced =
        replaces.is_some_and(|old| old.since.seconds_since(from) >= -DATING_TOLERANCE_S);
    // Reports are sent before samples: a server that has these samples has read the report.
    let is_analysed = stored.state != ReportState::Waiting && model.data_until > stored.written_at;
    is_effective && !is_known && !is_replaced && !is_analysed
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::logbook::LogbookKind;
    use binnacle_wire::logbook::Report;
    use binnacle_wire::messages::LogbookReport;
    use uuid::Uuid;

    fn at(text: &str) -> Timestamp {
        Timestamp::parse(text).unwrap()
    }

    fn model(data_until: &str, epoch_from: Option<&str>) -> ModelDownlink {
        let mut model = crate::corrected_heading::tests::model(1_000.0, None);
        model.data_until = at(data_until);
        model.replaces = epoch_from.map(|from| CardWithdrawn {
            since: at(from),
            reason: "adjustment".to_owned(),
        });
        model
    }

    fn report(kind: LogbookKind, from: &str) -> StoredReport {
        StoredReport {
            id: Uuid::nil(),
            sent: LogbookReport {
                revision: 1,
                reporter: String::new(),
                withdrawn: false,
                report: Report {
                    kind,
                    from: at(from),
                    to: None,
                    cargo: None,
                    hatch: None,
                    port: None,
                    note: String::new(),
                },
            },
            written_at: at("2026-11-20T12:00:00Z"),
            state: ReportState::Waiting,
            problem: None,
        }
    }

    fn ended(model: &ModelDownlink, report: StoredReport, now: &str) -> Option<String> {
        find_invalidation(model, &[report], at(now)).map(|ended| ended.reason)
    }

    const BEFORE: &str = "2026-11-20T06:00:00Z";
    const WORK: &str = "2026-11-20T09:00:00Z";
    const NOW: &str = "2026-11-20T13:00:00Z";

    #[test]
    fn an_adjustment_ends_the_card_at_once_and_cargo_does_not() {
        let old = model(BEFORE, None);
        let word = ended(&old, report(LogbookKind::Adjustment, WORK), NOW);
        assert_eq!(word.as_deref(), Some("adjustment"));
        for kind in [
            LogbookKind::MagneticCargo,
            LogbookKind::Lightning,
            LogbookKind::Note,
        ] {
            assert_eq!(ended(&old, report(kind, WORK), NOW), None);
        }
    }

    #[test]
    fn what_is_planned_ends_it_when_it_begins() {
        let old = model(BEFORE, None);
        let planned = report(LogbookKind::DryDocking, "2026-11-21T00:00:00Z");
        assert_eq!(ended(&old, planned.clone(), NOW), None);
        let word = ended(&old, planned, "2026-11-21T00:00:01Z");
        assert_eq!(word.as_deref(), Some("dry_docking"));
    }

    #[test]
    fn a_model_of_the_ship_since_holds() {
        for since in [WORK, "2026-11-20T15:00:00Z", "2026-11-19T10:00:00Z"] {
            let new = model("2026-11-21T06:00:00Z", Some(since));
            assert_eq!(
                ended(&new, report(LogbookKind::Adjustment, WORK), NOW),
                None
            );
        }
        let of_an_earlier_epoch = model(BEFORE, Some("2026-10-01T00:00:00Z"));
        assert!(
            ended(
                &of_an_earlier_epoch,
                report(LogbookKind::Welding, WORK),
                NOW
            )
            .is_some()
        );
    }

    #[test]
    fn a_report_that_is_taken_back_ends_nothing() {
        let old = model(BEFORE, None);
        let mut taken_back = report(LogbookKind::Adjustment, WORK);
        taken_back.sent.withdrawn = true;
        assert_eq!(ended(&old, taken_back, NOW), None);
    }

    #[test]
    fn work_of_long_ago_is_in_the_model() {
        let years = report(LogbookKind::Adjustment, "2025-03-01T08:00:00Z");
        assert_eq!(ended(&model(BEFORE, None), years, NOW), None);
    }

    /// The server has read the report and fitted later samples, so its model counts.
    #[test]
    fn what_the_server_fits_after_it_read_the_report_holds() {
        let later = model("2026-11-20T18:00:00Z", None);
        let mut ashore = report(LogbookKind::Welding, WORK);
        assert!(ended(&later, ashore.clone(), "2026-11-20T19:00:00Z").is_some());
        ashore.state = ReportState::Ashore;
        assert_eq!(ended(&later, ashore.clone(), "2026-11-20T19:00:00Z"), None);
        assert!(ended(&model(BEFORE, None), ashore, NOW).is_some());
    }
}
