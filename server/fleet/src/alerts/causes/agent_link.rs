//! Silent agents, and agents that two computers run.

use super::facts::{Silence, StreamConflict};
use super::row::{CardEffect, CauseRow, Condition, Ending, Finder, PlanEffect};
use crate::alerts::cause::Cause;
use binnacle_platform::severity::Severity;

/// Time without a batch after which a second sender counts as gone, seconds. Both may send only
/// once in three days.
const SHOWN_FOR_S: f64 = 7.0 * 86_400.0;

/// No upload for the days of the vessel's limit.
pub(super) const SILENT_AGENT: CauseRow = CauseRow {
    cause: Cause::SilentAgent,
    title: "no data from the vessel",
    finders: &[Finder::Clock(silent)],
    severity: |_| Severity::Notice,
    advice: |_| {
        "Ask the ship whether the agent's computer is on and what its page says of the link. Its \
         samples are kept on board and uploaded later."
    },
    on_card: CardEffect::None,
    on_plan: PlanEffect::None,
    ending: Ending::NotFound,
    ends_with_adjustment: false,
    is_redated: false,
};

/// Two computers with the same agent's files; revoking the agent ends it too.
pub(super) const CLONED_AGENT: CauseRow = CauseRow {
    cause: Cause::ClonedAgent,
    title: "two computers send as one agent",
    finders: &[Finder::Batch(cloned)],
    severity: |_| Severity::Warning,
    advice: |_| {
        "Find out which of them reads this ship's instruments, and stop the other. If that cannot \
         be settled from ashore, revoke the agent and enrol the right one again: its data is kept. \
         Until then the samples of both are used."
    },
    on_card: CardEffect::None,
    on_plan: PlanEffect::None,
    ending: Ending::AfterSilence {
        seconds: SHOWN_FOR_S,
    },
    ends_with_adjustment: false,
    is_redated: false,
};

fn silent(silence: &Silence<'_>) -> Option<Condition> {
    let last = silence.last_upload;
    let limit_days = silence.limits.silent_days;
    let days = silence.now.0.seconds_since(last.0) / 86_400.0;
    (days > limit_days).then(|| Condition {
        evidence: vec![format!(
            "The last batch arrived at {}.",
            last.to_the_minute()
        )],
        ..Condition::new(
            last,
            format!("The vessel's agent has sent nothing for more than {limit_days} days."),
        )
    })
}

fn cloned(conflict: &StreamConflict) -> Condition {
    let StreamConflict {
        stream, seq, newer, ..
    } = conflict;
    let opened_at = conflict.newer_opened_at;
    Condition {
        evidence: vec![
            format!("Stream {newer} was opened at {}.", opened_at.0),
            format!("Batch {seq} arrived in the older stream {stream} after that."),
        ],
        ..Condition::new(
            opened_at,
            "Two computers send as this compass's agent: one has a copy of the other's files."
                .to_owned(),
        )
    }
}
