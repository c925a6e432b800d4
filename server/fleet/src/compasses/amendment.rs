//! Amendment of a compass's record.

use super::{Compass, Role};
use binnacle_platform::error::Result;
use binnacle_platform::http::{Amended, optional_text, text};
use serde::Deserialize;
use utoipa::ToSchema;

/// Amendment of a compass. Absent fields stay as they are; null removes a value.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = CompassAmendment)]
pub(super) struct Amendment {
    /// Name.
    #[schema(min_length = 1, max_length = 200)]
    name: Option<String>,
    /// Role.
    role: Option<Role>,
    /// Maker and type.
    #[serde(default)]
    #[schema(value_type = Option<String>, max_length = 200, example = "Cassens & Plath Reflecta 1")]
    make: Amended<String>,
    /// Serial number.
    #[serde(default)]
    #[schema(value_type = Option<String>, max_length = 200, example = "34871")]
    serial_number: Amended<String>,
    /// Binnacle: maker, type and number.
    #[serde(default)]
    #[schema(value_type = Option<String>, max_length = 200, example = "Cassens & Plath type 11, no. 2047")]
    binnacle: Amended<String>,
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
