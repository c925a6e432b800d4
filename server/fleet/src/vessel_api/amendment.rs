//! Amendment of a vessel's record.

use crate::vessels::{NewVessel, VesselRow};
use binnacle_platform::error::Result;
use binnacle_platform::http::Amended;
use serde::Deserialize;
use utoipa::ToSchema;

/// Amendment of a vessel. Absent fields stay as they are; null removes a value.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = VesselAmendment)]
pub(super) struct Amendment {
    /// Name.
    #[schema(min_length = 1, max_length = 200)]
    name: Option<String>,
    /// IMO number with its check digit.
    #[serde(default)]
    #[schema(value_type = Option<String>, pattern = "^[0-9]{7}$", example = "9074729")]
    imo_number: Amended<String>,
    /// Call sign.
    #[serde(default)]
    #[schema(value_type = Option<String>, max_length = 200, example = "EAVN")]
    call_sign: Amended<String>,
    /// Flag state.
    #[serde(default)]
    #[schema(value_type = Option<String>, max_length = 200, example = "Spain")]
    flag: Amended<String>,
    /// State of the degaussing coils, in words.
    #[serde(default)]
    #[schema(value_type = Option<String>, max_length = 200, example = "no coils fitted")]
    degaussing: Amended<String>,
    /// Name of its class of sister ships, the same for each of them. A vessel keeps the prior that
    /// she was derived with.
    #[serde(default)]
    #[schema(value_type = Option<String>, max_length = 200, example = "Handymax 38")]
    sister_class: Amended<String>,
    /// False takes the vessel out of service: it leaves the fleet's lists, has no needs and raises
    /// no alert. All its records stay, and what its agents send is kept.
    pub(super) in_service: Option<bool>,
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
            sister_class: self.sister_class.over(vessel.sister_class),
        };
        amended.checked()
    }
}
