//! Binnacles: which correctors a design has, which of them are on board, and
//! how they stand.
//!
//! What always holds: a [`Design`] or [`Binnacle`] that exists was checked, so that
//! every hole, scale mark and magnet that it or its setting names is there, holes are
//! numbered from the bottom, and nothing is nearer the card than it can be. The
//! written form (docs/binnacle.md) is the value itself: both read as the form they
//! were made from, and cannot be changed but by making another.

mod aboard;
mod calibration;
mod check;
mod design;
mod error;
mod setting;
mod shipped;
mod stock;

pub use aboard::{Aboard, BinnacleForm, Lot};
pub use calibration::Calibrated;
pub use design::{
    Carrier, CompassKind, DesignForm, Flinders, Heeling, Hole, IronSize, MagnetKind, Mark,
    Quadrantal, Rack, Shape, Side,
};
pub use error::BinnacleError;
pub(crate) use setting::same;
pub use setting::{Axis, BarSetting, HeelingSetting, PairSetting, Red, Setting, Soft, Tray};
pub use shipped::SHIPPED;

use serde::{Deserialize, Serialize};
use std::ops::Deref;

/// The version of the written forms of this module.
pub const VERSION: u32 = 1;

/// A maker's binnacle, as all of its kind are: where correctors may stand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "DesignForm", into = "DesignForm")]
pub struct Design(DesignForm);

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
        let lot = form.aboard.magnets.iter_mut().find(|l| l.magnet == magnet);
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
    pub fn must_be_credible(&self) -> Result<(), BinnacleError> {
        stock::credible(&self.0)
    }
}

impl Deref for Design {
    type Target = DesignForm;
    fn deref(&self) -> &DesignForm {
        &self.0
    }
}

impl Deref for Binnacle {
    type Target = BinnacleForm;
    fn deref(&self) -> &BinnacleForm {
        &self.0
    }
}

impl TryFrom<DesignForm> for Design {
    type Error = BinnacleError;
    fn try_from(form: DesignForm) -> Result<Design, BinnacleError> {
        check::design(&form)?;
        Ok(Design(form))
    }
}

impl TryFrom<BinnacleForm> for Binnacle {
    type Error = BinnacleError;
    fn try_from(form: BinnacleForm) -> Result<Binnacle, BinnacleError> {
        stock::check(&form)?;
        calibration::check(&form)?;
        setting::check(&form, &form.setting)?;
        Ok(Binnacle(form))
    }
}

impl From<Design> for DesignForm {
    fn from(design: Design) -> DesignForm {
        design.0
    }
}

impl From<Binnacle> for BinnacleForm {
    fn from(binnacle: Binnacle) -> BinnacleForm {
        binnacle.0
    }
}

#[cfg(test)]
pub(crate) mod tests;
