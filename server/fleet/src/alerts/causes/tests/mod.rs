//! Tests of the table of causes, and of the alerts that its predicates raise.

mod agent_reports;
mod changes;
mod figures;

use super::CAUSES;
use super::row::{CardEffect, Ending, Source};
use crate::alerts::cause::Cause;
use std::collections::BTreeSet;
use utoipa::PartialSchema;

/// Returns all causes, as the OpenAPI document lists them.
fn all() -> Vec<Cause> {
    let schema = serde_json::to_value(Cause::schema()).unwrap();
    let names = schema["enum"].as_array().unwrap().clone();
    names
        .into_iter()
        .map(|name| serde_json::from_value(name).unwrap())
        .collect()
}

#[test]
fn every_cause_has_exactly_one_row() {
    let all = all();
    assert_eq!(all.len(), CAUSES.len());
    for cause in all {
        let rows = CAUSES.iter().filter(|row| row.cause == cause);
        assert_eq!(rows.count(), 1, "{cause:?}");
    }
}

#[test]
fn every_row_is_filled() {
    let titles: BTreeSet<&str> = CAUSES.iter().map(|row| row.title).collect();
    assert_eq!(titles.len(), CAUSES.len());
    for row in &CAUSES {
        assert!(!row.title.is_empty(), "{:?}", row.cause);
        assert!(!row.finders.is_empty(), "{:?}", row.cause);
    }
}

#[test]
fn only_alerts_that_end_after_silence_are_ended_by_the_clock() {
    for row in &CAUSES {
        let ends_after_silence = matches!(row.ending, Ending::AfterSilence { .. });
        let is_of_a_batch = matches!(row.source(), Source::Agent | Source::Batch);
        assert_eq!(ends_after_silence, is_of_a_batch, "{:?}", row.cause);
    }
}

#[test]
fn only_a_compass_that_cannot_be_trusted_has_no_card() {
    let blocked = CAUSES.iter().filter(|row| row.on_card == CardEffect::Block);
    let blocked: Vec<Cause> = blocked.map(|row| row.cause).collect();
    assert_eq!(blocked, [Cause::CompassFault, Cause::ReportedByAgent]);
}
