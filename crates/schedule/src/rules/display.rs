//! Rules as text.

use super::{Citation, EventKind};
use std::fmt;

impl fmt::Display for Citation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.document)?;
        if let Some(section) = &self.section {
            write!(f, ", {section}")?;
        }
        Ok(())
    }
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            EventKind::Installation => "the compass's installation or move",
            EventKind::DryDocking => "dry-docking",
            EventKind::StructuralChange => "a structural change",
            EventKind::ElectricalChange => "an electrical change",
        })
    }
}
