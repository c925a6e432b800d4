//! Samples that the logbook excludes from the current epoch's model.
//!
//! An entry without an end may exclude all of them.

use binnacle_compass::result::Analysis;
use serde::{Deserialize, Serialize};
use std::fmt;
use utoipa::ToSchema;

/// Number of samples of the current epoch that logbook entries leave out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct LeftOut {
    /// Left out by entries of magnetic cargo.
    #[schema(example = 288)]
    pub magnetic_cargo: u64,
    /// Left out by entries of a berth.
    #[schema(example = 12)]
    pub berth: u64,
}

impl LeftOut {
    /// Counts the samples that an analysis left out.
    pub fn from_analysis(analysis: &Analysis) -> LeftOut {
        let epoch = analysis.current_epoch();
        epoch.map_or_else(LeftOut::default, |epoch| LeftOut {
            magnetic_cargo: epoch.left_out_laden,
            berth: epoch.left_out_alongside,
        })
    }

    /// Tells whether there are any.
    pub fn any(&self) -> bool {
        *self != LeftOut::default()
    }
}

/// Continues the sentence of a refusal; empty where nothing is left out.
impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut kinds = Vec::new();
        if self.magnetic_cargo > 0 {
            kinds.push(format!("{} for magnetic cargo", self.magnetic_cargo));
        }
        if self.berth > 0 {
            kinds.push(format!("{} for a berth", self.berth));
        }
        if kinds.is_empty() {
            return Ok(());
        }
        let kinds = kinds.join(" and ");
        write!(
            f,
            "; because of logbook entries, samples are left out: {kinds}"
        )
    }
}
