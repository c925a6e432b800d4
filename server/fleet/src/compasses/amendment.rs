//! Amendment of a compass's record.

use super::{Compass, Role};
use binnacle_platform::error::Result;
use binnacle_platform::http::{Amended, optional_text, text};
use serde::Deserialize;
use utoipa::ToSchema;

/// Amendment of a compass.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Amendment {
    name: Option<String>,
    role: Option<Role>,
    #[serde(default)]
    make: Amended<String>,
    #[serde(default)]
    serial_number: Amended<String>,
    #[serde(default)]
    binnacle: Amended<String>,
}

/// Amendment of a compass. Absent fields stay as they are; null removes a value.
#[derive(ToSchema)]
#[schema(as = CompassAmendment)]
#[allow(dead_code, reason = "describes Amendment")]
pub(super) struct AmendmentSchema {
    #[schema(min_length = 1, max_length = 200)]
    name: Option<String>,
    role: Option<Role>,
    /// Maker and type.
    #[schema(max_length = 200, example = "Cassens & Plath Reflecta 1")]
    make: Option<String>,
    #[schema(max_length = 200, example = "34871")]
    serial_number: Option<String>,
    /// The binnacle's maker, type and number.
    #[schema(max_length = 200, example = "Cassens & Plath type 11, no. 2047")]
    binnacle: Option<String>,
}

impl Amendment {
    /// Returns the compass with the amendment applied.
    pub(super) fn applied_to(self, compass: Compass) -> Result<Compass> {
        let optional = |field, value: Option<String>| optional_text(field, value.as_deref());
        Ok(Compass {
            name: text("name", &self.name.unwrap_or(compass.name))?,
            role: self.role.unwrap_or(compass.role),
            make: optional("make", self.make.over(compass.make))?,
            serial_number: optional(
                "serial_number",
                self.serial_number.over(compass.serial_number),
            )?,
            binnacle: optional("binnacle", self.binnacle.over(compass.binnacle))?,
            ..compass
        })
    }
}
