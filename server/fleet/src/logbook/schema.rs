//! OpenAPI descriptions of a report. The wire crate owns the type.

use binnacle_platform::time::Time;
use serde::Serialize;
use utoipa::ToSchema;

/// One event, as its reporter writes it down.
#[derive(ToSchema)]
#[schema(as = LogbookReport)]
#[allow(dead_code, reason = "describes binnacle_wire::logbook::Report")]
pub(super) struct ReportSchema {
    kind: KindSchema,
    /// Time or beginning of the event.
    from: Time,
    /// Its end; none for an instant or for an event that still goes on.
    to: Option<Time>,
    /// Kind of magnetic cargo.
    cargo: Option<CargoSchema>,
    /// Place of the magnetic cargo.
    #[schema(max_length = 100, example = "2")]
    hatch: Option<String>,
    /// The port, where there is one.
    #[schema(max_length = 100)]
    port: Option<String>,
    /// In the reporter's own words.
    #[serde(default)]
    #[schema(max_length = 1000, default = "")]
    note: String,
}

/// Subject of a logbook entry.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = LogbookKind)]
#[allow(dead_code, reason = "describes binnacle_compass::logbook::LogbookKind")]
pub enum KindSchema {
    /// The compass was adjusted.
    Adjustment,
    /// A magnet, a sphere or the Flinders bar was moved without an adjustment.
    CorrectorChange,
    /// The compass or its bearing to the ship's head was altered.
    CompassMoved,
    /// Structural or electrical work.
    Repair,
    /// A stay in dock.
    DryDocking,
    /// Welding near the compass or on the hull.
    Welding,
    /// Degaussing or deperming.
    Degaussing,
    /// The ship was struck or came near to it.
    Lightning,
    /// Collision, grounding or another heavy blow.
    Shock,
    /// Magnetic cargo on board.
    MagneticCargo,
    /// Alongside.
    Berth,
    /// Anything else; it changes nothing in the analysis.
    Note,
}

/// Kind of magnetic cargo.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = CargoKind)]
#[allow(dead_code, reason = "describes binnacle_compass::logbook::Cargo")]
pub(super) enum CargoSchema {
    /// Plates, coils, pipes, rails.
    Steel,
    /// Scrap iron, which carries magnetism of its own.
    Scrap,
    /// Containers, whatever is in them.
    Containers,
    /// Anything else that moves the compass.
    Other,
}

/// An officer's report, whole.
#[derive(ToSchema)]
#[schema(as = BoardReport)]
#[allow(dead_code, reason = "describes binnacle_wire::messages::LogbookReport")]
pub(super) struct BoardReportSchema {
    /// From 1; one more each time the officer changes the report.
    #[schema(minimum = 1)]
    revision: u32,
    /// The officer's name, or nothing.
    #[serde(default)]
    #[schema(max_length = 100, default = "")]
    reporter: String,
    /// True if the officer withdraws the report.
    #[serde(default)]
    #[schema(default = false)]
    withdrawn: bool,
    #[serde(flatten)]
    report: ReportSchema,
}

/// A report that is in the logbook.
#[derive(ToSchema)]
#[schema(as = BoardReportAnswer)]
#[allow(dead_code, reason = "describes binnacle_wire::messages::LogbookAnswer")]
pub(super) struct BoardAnswerSchema {
    /// The latest revision from on board that is there.
    revision: u32,
    /// True if the entry was withdrawn, on board or ashore.
    withdrawn: bool,
}
