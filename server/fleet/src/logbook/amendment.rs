//! Amendment of an entry. Absent fields stay as they are; null removes a value.

use super::entry::NewEntry;
use binnacle_compass::logbook::{Cargo, LogbookKind};
use binnacle_platform::http::Amended;
use binnacle_platform::ids::CompassId;
use binnacle_platform::time::Time;
use binnacle_wire::logbook::Report;
use serde::Deserialize;
use utoipa::ToSchema;

/// Amendment of an entry. Absent fields stay as they are; null removes a value.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = LogbookAmendment)]
pub(super) struct Amendment {
    /// Kind of event.
    kind: Option<LogbookKind>,
    /// Time of the event, or its start.
    from: Option<Time>,
    /// Its end.
    #[serde(default)]
    #[schema(value_type = Option<Time>)]
    to: Amended<Time>,
    /// Kind of magnetic cargo.
    #[serde(default)]
    #[schema(value_type = Option<Cargo>)]
    cargo: Amended<Cargo>,
    /// Hatch in which the magnetic cargo lies.
    #[serde(default)]
    #[schema(value_type = Option<String>, max_length = 100)]
    hatch: Amended<String>,
    /// Port.
    #[serde(default)]
    #[schema(value_type = Option<String>, max_length = 100)]
    port: Amended<String>,
    /// The reporter's own words.
    #[schema(max_length = 1000)]
    note: Option<String>,
    /// Compass that the entry concerns; null for the whole ship.
    #[serde(default)]
    #[schema(value_type = Option<CompassId>)]
    compass_id: Amended<CompassId>,
}

impl Amendment {
    /// Returns the entry with the amendment applied.
    pub(super) fn applied_to(self, entry: NewEntry) -> NewEntry {
        let report = entry.report;
        NewEntry {
            report: Report {
                kind: self.kind.unwrap_or(report.kind),
                from: self.from.map_or(report.from, |from| from.0),
                to: self.to.over(report.to.map(Time)).map(|to| to.0),
                cargo: self.cargo.over(report.cargo),
                hatch: self.hatch.over(report.hatch),
                port: self.port.over(report.port),
                note: self.note.unwrap_or(report.note),
            },
            compass_id: self.compass_id.over(entry.compass_id),
        }
    }
}
