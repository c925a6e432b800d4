//! What people report about a ship that bears on her magnetism.

use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// One entry of the magnetic logbook.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LogbookEntry {
    /// When it happened, or began.
    pub from: Timestamp,
    /// When it ended, for what lasts (cargo on board); none for an event or
    /// for what still goes on.
    #[serde(default)]
    pub to: Option<Timestamp>,
    /// What happened.
    pub kind: LogbookKind,
    /// In the reporter's own words.
    #[serde(default)]
    pub note: String,
}

/// What a logbook entry is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LogbookKind {
    /// The correctors were moved: what was learnt before holds no more.
    Adjustment,
    /// Structural or electrical work, or a dry-docking.
    Repair,
    /// The ship was struck or came near to it.
    Lightning,
    /// Degaussing or deperming.
    Degaussing,
    /// Collision, grounding or another heavy blow.
    Shock,
    /// Magnetic cargo on board from `from` to `to`.
    MagneticCargo,
    /// The compass or its bearing to the ship's head was altered.
    CompassMoved,
    /// Anything else; it changes nothing in the analysis.
    Note,
}

impl LogbookKind {
    /// Whether the ship before and after such an entry is to be taken for two
    /// different magnets, whatever the data say.
    pub fn ends_an_epoch(self) -> bool {
        match self {
            LogbookKind::Adjustment
            | LogbookKind::Repair
            | LogbookKind::Degaussing
            | LogbookKind::CompassMoved => true,
            LogbookKind::Lightning
            | LogbookKind::Shock
            | LogbookKind::MagneticCargo
            | LogbookKind::Note => false,
        }
    }
}
