//! Binnacles: design, correctors on board, and their setting.
//!
//! Invariants: a [`Design`] or [`Binnacle`] is always valid. Every hole, scale mark and
//! magnet that it or its setting names exists, holes are numbered from the bottom, and
//! nothing is closer to the card than physically possible. The written form
//! (docs/binnacle.md) is the value itself: both types read as the form they were made from,
//! and cannot be changed except by making another.

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

/// One binnacle on board: its design, serial number, correctors, setting, and calibration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "BinnacleForm", into = "BinnacleForm")]
pub struct Binnacle(BinnacleForm);

impl Binnacle {
    /// Returns the binnacle with another setting.
    ///
    /// # Errors
    /// Fails when the setting names something that does not exist or is not on board.
    pub fn with_setting(&self, setting: Setting) -> Result<Binnacle, BinnacleError> {
        let mut form = self.0.clone();
        form.setting = setting;
        Binnacle::try_from(form)
    }

    /// Returns the binnacle with another tested moment for a lot of magnets.
    ///
    /// # Errors
    /// Fails when there is no such lot, or the moment is invalid.
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

    /// Checks that tested moments are plausible for magnets of their kind.
    ///
    /// # Errors
    /// Names the lot with an implausible tested moment.
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
