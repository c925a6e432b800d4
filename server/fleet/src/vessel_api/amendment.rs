//! Amendment of a vessel's record.

use crate::vessels::{NewVessel, VesselRow};
use binnacle_platform::error::Result;
use binnacle_platform::http::Amended;
use serde::Deserialize;
use utoipa::ToSchema;

/// Amendment of a vessel.
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

/// Amendment of a vessel. Absent fields stay as they are; null removes a value.
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
    /// State of its degaussing coils, in words.
    #[schema(max_length = 200, example = "no coils fitted")]
    degaussing: Option<String>,
    /// False takes the vessel out of service: it leaves the fleet's lists, has no needs and raises
    /// no alert. All its records stay, and what its agents send is kept.
    in_service: Option<bool>,
}

impl Amendment {
    /// Returns the vessel's particulars with the amendment applied.
    pub(super) fn applied_to(self, vessel: VesselRow) -> Result<NewVessel> {
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
