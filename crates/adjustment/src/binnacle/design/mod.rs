//! Design of a binnacle.

mod check;
mod form;

pub use form::{
    Carrier, CompassKind, DesignForm, Flinders, Heeling, Hole, IronSize, MagnetKind, Mark,
    Quadrantal, Rack, Shape, Side,
};

use super::error::BinnacleError;
use serde::{Deserialize, Serialize};
use std::ops::Deref;

/// Design of a maker's binnacles: possible positions of all correctors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "DesignForm", into = "DesignForm")]
pub struct Design(DesignForm);

impl Deref for Design {
    type Target = DesignForm;
    fn deref(&self) -> &DesignForm {
        &self.0
    }
}

impl TryFrom<DesignForm> for Design {
    type Error = BinnacleError;
    fn try_from(form: DesignForm) -> Result<Design, BinnacleError> {
        check::check(&form)?;
        Ok(Design(form))
    }
}

impl From<Design> for DesignForm {
    fn from(design: Design) -> DesignForm {
        design.0
    }
}
