//! What people report about a ship that bears on her magnetism.
//!
//! What always holds: an entry that was read ends no earlier than it begins.
//! Entries may overlap, lie before the first sample or after the last, and stand
//! in any order: an entry's effect depends on itself and on the sample alone.

use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// One entry of the magnetic logbook.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct LogbookEntry {
    /// When it happened, or began.
    pub from: Timestamp,
    /// When it ended, for what lasts (cargo on board, a berth); none for an
    /// event or for what still goes on.
    pub to: Option<Timestamp>,
    /// What happened.
    pub kind: LogbookKind,
    /// What the magnetic cargo was, where that is known.
    pub cargo: Option<Cargo>,
    /// In the reporter's own words.
    pub note: String,
}

/// What a logbook entry is about; what upsets most comes first, and gives its
/// name to an epoch that several begin at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LogbookKind {
    /// The compass was adjusted: what was learnt before holds no more.
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
    /// Magnetic cargo on board from `from` to `to`.
    MagneticCargo,
    /// Alongside from `from` to `to`: among cranes, piles and other ships.
    Berth,
    /// Anything else; it changes nothing in the analysis.
    Note,
}

/// What a magnetic cargo consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cargo {
    /// Plates, coils, pipes, rails.
    Steel,
    /// Scrap iron, which carries magnetism of its own.
    Scrap,
    /// Containers, whatever is in them.
    Containers,
    /// Anything else that moves the compass.
    Other,
}

/// Why something is no logbook entry.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LogbookError {
    /// It would end before it begins.
    #[error("to: {to} is before from, {from}")]
    EndsBeforeItBegins {
        /// When it begins.
        from: Timestamp,
        /// When it would end.
        to: Timestamp,
    },
    /// Only magnetic cargo consists of something.
    #[error("cargo: only an entry of kind magnetic_cargo has one")]
    UnexpectedCargo,
}

impl LogbookEntry {
    /// The entry, if it can be one.
    ///
    /// # Errors
    /// When it ends before it begins, or names a cargo and is about none.
    pub fn checked(self) -> Result<LogbookEntry, LogbookError> {
        let from = self.from;
        if let Some(to) = self.to.filter(|to| *to < from) {
            return Err(LogbookError::EndsBeforeItBegins { from, to });
        }
        if self.cargo.is_some() && self.kind != LogbookKind::MagneticCargo {
            return Err(LogbookError::UnexpectedCargo);
        }
        Ok(self)
    }

    /// The entry as it stands at a time: what ends later goes on yet.
    pub fn as_of(&self, until: Timestamp) -> LogbookEntry {
        LogbookEntry {
            to: self.to.filter(|to| *to <= until),
            ..self.clone()
        }
    }
}

impl LogbookKind {
    /// Whether the ship before and after such an entry is to be taken for two
    /// different magnets, whatever the data say.
    pub fn ends_an_epoch(self) -> bool {
        match self {
            LogbookKind::Adjustment
            | LogbookKind::CorrectorChange
            | LogbookKind::CompassMoved
            | LogbookKind::Repair
            | LogbookKind::DryDocking
            | LogbookKind::Welding
            | LogbookKind::Degaussing => true,
            LogbookKind::Lightning
            | LogbookKind::Shock
            | LogbookKind::MagneticCargo
            | LogbookKind::Berth
            | LogbookKind::Note => false,
        }
    }

    /// Whether the iron of ship and binnacle is much what it was, so that what the
    /// epoch before tells of it still counts.
    pub fn preserves_soft_iron(self) -> bool {
        matches!(
            self,
            LogbookKind::Repair
                | LogbookKind::Degaussing
                | LogbookKind::DryDocking
                | LogbookKind::Welding
        )
    }

    /// As a sentence names it.
    pub fn description(self) -> &'static str {
        match self {
            LogbookKind::Adjustment => "the compass was adjusted",
            LogbookKind::CorrectorChange => "a corrector was moved",
            LogbookKind::CompassMoved => "the compass was moved",
            LogbookKind::Repair => "structural or electrical work",
            LogbookKind::DryDocking => "a stay in dock",
            LogbookKind::Welding => "welding",
            LogbookKind::Degaussing => "degaussing",
            LogbookKind::Lightning => "lightning",
            LogbookKind::Shock => "a heavy blow",
            LogbookKind::MagneticCargo => "magnetic cargo",
            LogbookKind::Berth => "a berth",
            LogbookKind::Note => "a note",
        }
    }
}

/// An entry as it is written.
#[derive(Deserialize)]
struct Unchecked {
    from: Timestamp,
    #[serde(default)]
    to: Option<Timestamp>,
    kind: LogbookKind,
    #[serde(default)]
    cargo: Option<Cargo>,
    #[serde(default)]
    note: String,
}

impl TryFrom<Unchecked> for LogbookEntry {
    type Error = LogbookError;

    fn try_from(read: Unchecked) -> Result<LogbookEntry, LogbookError> {
        LogbookEntry {
            from: read.from,
            to: read.to,
            kind: read.kind,
            cargo: read.cargo,
            note: read.note,
        }
        .checked()
    }
}
