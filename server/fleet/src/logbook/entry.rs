//! Entries of the logbook, as requests and responses carry them.

use binnacle_compass::logbook::{Cargo, LogbookKind};
use binnacle_compass::time::Timestamp;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::time;
use binnacle_platform::ids::{CompassId, EntryId};
use binnacle_platform::time::Time;
use binnacle_wire::logbook::{Report, ReportError};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// An entry to be written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(from = "NewEntryForm")]
#[schema(example = json!({ "kind": "lightning", "from": "2026-11-20T03:00:00Z" }))]
pub(super) struct NewEntry {
    /// The event.
    #[serde(flatten)]
    pub(super) report: Report,
    /// The compass that it concerns; the whole ship if none is named. Only work on a
    /// compass, and a note, may name one.
    pub(super) compass_id: Option<CompassId>,
}

/// An entry to be written, field by field. One that is not known may be a known one
/// misspelt, and is refused; reports from on board, which newer agents write, are not
/// read by this.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a logbook entry")]
struct NewEntryForm {
    kind: LogbookKind,
    from: Timestamp,
    to: Option<Timestamp>,
    cargo: Option<Cargo>,
    hatch: Option<String>,
    port: Option<String>,
    #[serde(default)]
    note: String,
    compass_id: Option<CompassId>,
}

impl From<NewEntryForm> for NewEntry {
    fn from(written: NewEntryForm) -> NewEntry {
        NewEntry {
            report: Report {
                kind: written.kind,
                from: written.from,
                to: written.to,
                cargo: written.cargo,
                hatch: written.hatch,
                port: written.port,
                note: written.note,
            },
            compass_id: written.compass_id,
        }
    }
}

/// An entry of a vessel's logbook.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub(super) struct LogbookEntry {
    /// The entry's id.
    pub(super) id: EntryId,
    /// The event.
    #[serde(flatten)]
    pub(super) report: Report,
    /// The compass that it concerns; none for the whole ship.
    #[schema(required)]
    pub(super) compass_id: Option<CompassId>,
    /// Time at which the server received it.
    pub(super) created_at: Time,
    /// The reporter's name; empty when a report from on board gives none.
    pub(super) created_by: String,
    /// Place of its author.
    pub(super) author: AuthorKind,
    /// Counts from 1.
    pub(super) revision: u32,
    /// Time of the last amendment.
    #[schema(required)]
    pub(super) revised_at: Option<Time>,
    /// Author of the last amendment.
    #[schema(required)]
    pub(super) revised_by: Option<String>,
    /// Time of withdrawal, from which the entry has no effect.
    #[schema(required)]
    pub(super) withdrawn_at: Option<Time>,
    /// Person who withdrew it.
    #[schema(required)]
    pub(super) withdrawn_by: Option<String>,
    /// Reason for the withdrawal.
    #[schema(required)]
    pub(super) withdrawal_reason: Option<String>,
}

/// Place at which an entry was reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = LogbookAuthor)]
pub(crate) enum AuthorKind {
    /// On shore, by one of the operator's people or programs.
    User,
    /// On board, on the agent's page.
    Agent,
    /// By an adjuster firm.
    Firm,
}

/// A page of a logbook.
#[derive(Serialize, ToSchema)]
pub(super) struct LogbookList {
    /// Entries, the latest event first.
    pub(super) items: Vec<LogbookEntry>,
    /// `after` of the next page.
    #[schema(required)]
    pub(super) next: Option<String>,
}

/// An entry with all its revisions.
#[derive(Serialize, ToSchema)]
pub(super) struct RevisedEntry {
    /// The latest revision.
    #[serde(flatten)]
    pub(super) entry: LogbookEntry,
    /// All revisions, the first one first.
    pub(super) revisions: Vec<Revision>,
}

/// A revision of an entry.
#[derive(Serialize, ToSchema)]
pub(super) struct Revision {
    /// Counts from 1.
    pub(super) number: u32,
    /// Time of the revision.
    pub(super) at: Time,
    /// Place of its author.
    pub(super) author: AuthorKind,
    /// Name of its author; empty when a report from on board does not say.
    pub(super) author_name: String,
    /// The entry in this revision.
    pub(super) entry: NewEntry,
}

/// Reason for which an entry is withdrawn.
#[derive(Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Withdrawal {
    /// In a few words.
    #[schema(max_length = 200)]
    pub(super) reason: Option<String>,
}

/// Selection of entries.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Filter {
    /// Of this kind only.
    #[param(value_type = Option<LogbookKind>)]
    kind: Option<LogbookKind>,
    /// Entries that had not ended before this instant, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    from: Option<String>,
    /// Entries that began before this instant, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    to: Option<String>,
    /// Includes withdrawn entries; true by default.
    withdrawn: Option<bool>,
}

/// Selection of entries, parsed and checked.
pub(super) struct CheckedFilter {
    pub(super) kind: Option<LogbookKind>,
    pub(super) from: Option<Time>,
    pub(super) to: Option<Time>,
    pub(super) withdrawn: bool,
}

impl NewEntry {
    /// Returns the entry, if it is valid at this time.
    pub(super) fn checked(self, now: Timestamp) -> Result<NewEntry> {
        let report = self.report.checked(now).map_err(invalid_report)?;
        let report = report.ending_within_a_year(now).map_err(invalid_report)?;
        if self.compass_id.is_some() && !may_name_a_compass(report.kind) {
            return Err(Error::Invalid {
                field: "compass_id",
                detail: "an entry of this kind concerns the whole vessel".to_owned(),
            });
        }
        Ok(NewEntry { report, ..self })
    }
}

impl LogbookEntry {
    /// Returns its content.
    pub(super) fn content(&self) -> NewEntry {
        NewEntry {
            report: self.report.clone(),
            compass_id: self.compass_id,
        }
    }

    /// Returns `after` of the page that begins behind it.
    pub(super) fn cursor(&self) -> String {
        format!("{}.{}", self.report.from.micros(), self.id)
    }
}

impl Filter {
    pub(super) fn checked(self) -> Result<CheckedFilter> {
        Ok(CheckedFilter {
            kind: self.kind,
            from: time("from", self.from.as_deref())?.map(Time),
            to: time("to", self.to.as_deref())?.map(Time),
            withdrawn: self.withdrawn.unwrap_or(true),
        })
    }
}

/// Returns the refusal of an invalid report.
pub(super) fn invalid_report(error: ReportError) -> Error {
    Error::Invalid {
        field: error.field,
        detail: error.detail,
    }
}

fn may_name_a_compass(kind: LogbookKind) -> bool {
    matches!(
        kind,
        LogbookKind::Adjustment
            | LogbookKind::CorrectorChange
            | LogbookKind::CompassMoved
            | LogbookKind::Repair
            | LogbookKind::Note
    )
}
