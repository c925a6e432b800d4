//! Binnacles: which correctors a design has, which of them are on board, and
//! how they stand.
//!
//! What always holds: a [`Design`] or [`Binnacle`] that exists was checked, so that
//! every hole, scale mark and magnet that it or its setting names is there, holes are
//! numbered from the bottom, and nothing is nearer the card than it can be. The
//! written form (docs/binnacle.md) is the value itself: both read as the form they
//! were made from, and cannot be changed but by making another.

mod axis;

mod design;
mod shipped;

mod calibration;
mod inventory;
mod setting;

mod binnacle_form;
mod checks;

mod error;
mod nearly_equal;
mod value_checks;

pub use axis::{Axis, Red};
pub use binnacle_form::BinnacleForm;
pub use calibration::Calibrated;
pub use design::{
    Carrier, CompassKind, Design, DesignForm, Flinders, Heeling, Hole, IronSize, MagnetKind, Mark,
    Quadrantal, Rack, Shape, Side,
};
pub use error::BinnacleError;
pub use inventory::{Inventory, Lot};
pub(crate) use nearly_equal::nearly_equal;
pub use setting::{BarSetting, HeelingSetting, PairSetting, Setting, Soft, Tray};
pub use shipped::SHIPPED;
pub use value_checks::VERSION;

use serde::{Deserialize, Serialize};
use std::ops::Deref;

/// One binnacle on board: its design, serial, the correctors there are, how they
/// stand, and what was measured of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "BinnacleForm", into = "BinnacleForm")]
pub struct Binnacle(BinnacleForm);

impl Binnacle {
    /// The same binnacle with its correctors standing otherwise.
    ///
    /// # Errors
    /// Names what is not there, or not on board.
    pub fn with_setting(&self, setting: Setting) -> Result<Binnacle, BinnacleError> {
        let mut form = self.0.clone();
        form.setting = setting;
        Binnacle::try_from(form)
    }

    /// The same binnacle with another moment for a lot of magnets, as it was found
    /// out on the way.
    ///
    /// # Errors
    /// When there is no such lot, or the moment is none.
    pub fn with_moment(
        &self,
        magnet: &str,
        moment_am2: f64,
        sd: f64,
    ) -> Result<Binnacle, BinnacleError> {
        let mut form = self.0.clone();
        let lot = form
            .inventory
            .magnets
            .iter_mut()
            .find(|l| l.magnet == magnet);
        let Some(lot) = lot else {
            let what = format!("no magnets {magnet:?} are on board");
            return Err(BinnacleError::new("aboard.magnets", what));
        };
        lot.tested_moment_am2 = Some(moment_am2);
        lot.tested_sd = Some(sd);
        Binnacle::try_from(form)
    }

    /// Refuses to have written what no magnet of its kind can have.
    ///
    /// # Errors
    /// Names the lot whose tested moment it is, A·m².
    pub fn check_tested_moments(&self) -> Result<(), BinnacleError> {
        checks::check_tested_moments(&self.0)
    }
}

impl Deref for Binnacle {
    type Target = BinnacleForm;
    fn deref(&self) -> &BinnacleForm {
        &self.0
    }
}

impl TryFrom<BinnacleForm> for Binnacle {
    type Error = BinnacleError;
    fn try_from(form: BinnacleForm) -> Result<Binnacle, BinnacleError> {
        checks::check_binnacle(&form)?;
        Ok(Binnacle(form))
    }
}

impl From<Binnacle> for BinnacleForm {
    fn from(binnacle: Binnacle) -> BinnacleForm {
        binnacle.0
    }
}

#[cfg(test)]
pub(crate) mod tests;
