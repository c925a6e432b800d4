//! Magnetic logbook: reported events that affect a ship's magnetism.
//!
//! Invariants: a valid entry ends no earlier than it begins. Entries may overlap, lie
//! before the first sample or after the last, and come in any order. An entry's effect
//! depends only on itself and on the sample.

use crate::time::Timestamp;
use serde::{Deserialize, Serialize};

/// One entry of the magnetic logbook.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct LogbookEntry {
    /// Time of the event, or its beginning.
    pub from: Timestamp,
    /// End of a lasting condition (cargo on board, a berth); none for an event or an
    /// ongoing condition.
    pub to: Option<Timestamp>,
    /// Kind of event.
    pub kind: LogbookKind,
    /// Kind of the magnetic cargo, where known.
    pub cargo: Option<Cargo>,
    /// Free text of the reporter.
    pub note: String,
}

/// Kind of a logbook entry, the most disruptive first. The first kind names an epoch that
/// several entries begin at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum LogbookKind {
    /// Adjustment of the compass: earlier knowledge no longer applies.
    Adjustment,
    /// A corrector (magnet, sphere or Flinders bar) moved without an adjustment.
    CorrectorChange,
    /// The compass, or its alignment with the ship's head, was altered.
    CompassMoved,
    /// Structural or electrical work.
    Repair,
    /// A stay in dock.
    DryDocking,
    /// Welding near the compass or on the hull.
    Welding,
    /// Degaussing or deperming.
    Degaussing,
    /// Lightning strike on the ship or nearby.
    Lightning,
    /// Collision, grounding or another heavy blow.
    Shock,
    /// Magnetic cargo on board from `from` to `to`.
    MagneticCargo,
    /// Alongside from `from` to `to`: near cranes, piles and other ships.
    Berth,
    /// Anything else; without effect on the analysis.
    Note,
}

/// Kind of magnetic cargo.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = CargoKind))]
#[serde(rename_all = "snake_case")]
pub enum Cargo {
    /// Plates, coils, pipes, rails.
    Steel,
    /// Scrap iron, which carries magnetism of its own.
    Scrap,
    /// Containers with any content.
    Containers,
    /// Other cargo that affects the compass.
    Other,
}

/// Error of an invalid logbook entry.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LogbookError {
    /// The end is before the beginning.
    #[error("to: {to} is before from, {from}")]
    EndsBeforeItBegins {
        /// Given beginning.
        from: Timestamp,
        /// Given end.
        to: Timestamp,
    },
    /// A cargo is given for an entry of another kind.
    #[error("cargo: allowed only for kind magnetic_cargo")]
    UnexpectedCargo,
}

impl LogbookEntry {
    /// Validates the entry.
    ///
    /// # Errors
    /// Fails when it ends before it begins, or has a cargo and is of another kind.
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

    /// Returns the entry as it stood just before a time: none if it began later, and open if it
    /// ended later.
    pub fn known_before(&self, end: Timestamp) -> Option<LogbookEntry> {
        (self.from < end).then(|| LogbookEntry {
            to: self.to.filter(|to| *to < end),
            ..self.clone()
        })
    }

    /// Returns the entry as known at a time: a later end is still open.
    pub fn as_of(&self, until: Timestamp) -> LogbookEntry {
        LogbookEntry {
            to: self.to.filter(|to| *to <= until),
            ..self.clone()
        }
    }
}

impl LogbookKind {
    /// Returns true when such an entry always begins a new epoch, whatever the data show.
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

    /// Returns true when soft iron of ship and binnacle stays nearly the same, so that the
    /// previous epoch still informs about it.
    pub fn preserves_soft_iron(self) -> bool {
        matches!(
            self,
            LogbookKind::Repair
                | LogbookKind::Degaussing
                | LogbookKind::DryDocking
                | LogbookKind::Welding
        )
    }

    /// Description of the kind within a sentence.
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

/// Written form of an entry, before validation.
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
