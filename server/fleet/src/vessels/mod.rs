//! Vessels of a fleet: identity, last position, and whether they are in service.
//!
//! Invariants:
//!
//! - A vessel is found only together with its operator.
//! - An IMO number is one vessel's within an operator, but for duplicates from before that rule.
//! - A vessel out of service is found by its id, with all its records. The fleet's lists leave it
//!   out.

mod imo;
mod store;

pub use store::{
    VesselNames, VesselRow, find_operator, find_owner, find_row, is_in_service, must_be_in_fleet,
    names,
};
pub(crate) use store::{
    insert, list, lock, lock_entries, require_free_imo, set_out_of_service, update,
};

use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::{optional_text, text};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Last known position of a vessel.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
pub struct LastPosition {
    /// Degrees north.
    pub lat: f64,
    /// Degrees east.
    pub lon: f64,
    /// Time.
    pub at: Time,
}

/// A vessel to be entered.
#[derive(Deserialize, Serialize, ToSchema)]
#[schema(example = json!({ "name": "Nao Victoria", "imo_number": "9074729", "flag": "ES" }))]
pub struct NewVessel {
    /// Its name.
    #[schema(min_length = 1, max_length = 200)]
    pub name: String,
    /// Its IMO number, with its check digit.
    #[schema(pattern = "^[0-9]{7}$", example = "9074729")]
    pub imo_number: Option<String>,
    /// Its call sign.
    pub call_sign: Option<String>,
    /// Its flag state.
    pub flag: Option<String>,
    /// State of its degaussing coils, in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200, example = "no coils fitted")]
    pub degaussing: Option<String>,
    /// Name of its class of sister ships, the same for each of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200, example = "Handymax 38")]
    pub sister_class: Option<String>,
}

impl NewVessel {
    /// Returns the vessel with its texts trimmed.
    ///
    /// # Errors
    /// Fails when a text is empty or too long, or the IMO number is wrong.
    pub(crate) fn checked(self) -> Result<NewVessel> {
        let imo_number = optional_text("imo_number", self.imo_number.as_deref())?;
        if let Some(number) = &imo_number
            && !imo::is_valid(number)
        {
            return Err(Error::Invalid {
                field: "imo_number",
                detail: format!(
                    "{number} is not an IMO number: seven digits, the last one a check digit"
                ),
            });
        }
        Ok(NewVessel {
            name: text("name", &self.name)?,
            imo_number,
            call_sign: optional_text("call_sign", self.call_sign.as_deref())?,
            flag: optional_text("flag", self.flag.as_deref())?,
            degaussing: optional_text("degaussing", self.degaussing.as_deref())?,
            sister_class: optional_text("sister_class", self.sister_class.as_deref())?,
        })
    }
}
