//! Reading of the vertical field.

use crate::berth::BerthError;
use serde::{Deserialize, Serialize};

/// Vertical field at the card's place, with the correctors in their setting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VerticalReading {
    /// Field, nT, down positive.
    pub down_nt: f64,
}

impl VerticalReading {
    pub(crate) fn check_range(self) -> Result<(), BerthError> {
        if (-200_000.0..=200_000.0).contains(&self.down_nt) {
            return Ok(());
        }
        Err(BerthError::Reading {
            name: "down_nt",
            value: self.down_nt,
            least: -200_000.0,
            greatest: 200_000.0,
        })
    }
}
