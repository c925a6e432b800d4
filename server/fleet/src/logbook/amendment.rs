//! Amendment of an entry. Absent fields stay as they are; null removes a value.

use super::entry::NewEntry;
use super::schema::{CargoSchema, KindSchema};
use binnacle_compass::logbook::{Cargo, LogbookKind};
use binnacle_platform::http::Amended;
use binnacle_platform::ids::CompassId;
use binnacle_platform::time::Time;
use binnacle_wire::logbook::Report;
use serde::Deserialize;
use utoipa::ToSchema;

/// Amendment of an entry.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Amendment {
    kind: Option<LogbookKind>,
    from: Option<Time>,
    #[serde(default)]
    to: Amended<Time>,
    #[serde(default)]
    cargo: Amended<Cargo>,
    #[serde(default)]
    hatch: Amended<String>,
    #[serde(default)]
    port: Amended<String>,
    note: Option<String>,
    #[serde(default)]
    compass_id: Amended<CompassId>,
}

/// Amendment of an entry. Absent fields stay as they are; null removes a value.
#[derive(ToSchema)]
#[schema(as = LogbookAmendment)]
#[allow(dead_code, reason = "describes Amendment")]
pub(super) struct AmendmentSchema {
    kind: Option<KindSchema>,
    from: Option<Time>,
    to: Option<Time>,
    cargo: Option<CargoSchema>,
    #[schema(max_length = 100)]
    hatch: Option<String>,
    #[schema(max_length = 100)]
    port: Option<String>,
    #[schema(max_length = 1000)]
    note: Option<String>,
    compass_id: Option<CompassId>,
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
