//! A change of what is written of a vessel.

use super::{NewVessel, store};
use binnacle_platform::error::Result;
use binnacle_platform::http::Amended;
use serde::Deserialize;
use utoipa::ToSchema;

/// What is to be changed of a vessel.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Amendment {
    name: Option<String>,
    #[serde(default)]
    imo_number: Amended<String>,
    #[serde(default)]
    call_sign: Amended<String>,
    #[serde(default)]
    flag: Amended<String>,
    #[serde(default)]
    degaussing: Amended<String>,
    pub(super) in_service: Option<bool>,
}

/// What is to be changed of a vessel; what is left out stays, null takes a value away.
#[derive(ToSchema)]
#[schema(as = VesselAmendment)]
#[allow(dead_code, reason = "describes Amendment")]
pub(super) struct AmendmentSchema {
    #[schema(min_length = 1, max_length = 200)]
    name: Option<String>,
    /// With its check digit.
    #[schema(pattern = "^[0-9]{7}$", example = "9074729")]
    imo_number: Option<String>,
    #[schema(max_length = 200, example = "EAVN")]
    call_sign: Option<String>,
    /// The flag state.
    #[schema(max_length = 200, example = "Spain")]
    flag: Option<String>,
    /// How her degaussing coils are, in words.
    #[schema(max_length = 200, example = "no coils fitted")]
    degaussing: Option<String>,
    /// False takes her out of service: she is in the fleet's lists no more, needs nothing and
    /// calls for no alert; all that is stored of her stays, and what her agents send is kept.
    in_service: Option<bool>,
}

impl Amendment {
    /// The vessel's particulars with what is to be changed.
    pub(super) fn applied_to(self, vessel: store::Row) -> Result<NewVessel> {
        let amended = NewVessel {
            name: self.name.unwrap_or(vessel.name),
            imo_number: self.imo_number.over(vessel.imo_number),
            call_sign: self.call_sign.over(vessel.call_sign),
            flag: self.flag.over(vessel.flag),
            degaussing: self.degaussing.over(vessel.degaussing),
        };
        amended.checked()
    }
}
