//! Record of a compass.

use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A magnetic compass on board.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
pub struct Compass {
    /// The compass's id.
    pub id: CompassId,
    /// The vessel it belongs to.
    #[serde(skip)]
    pub vessel_id: VesselId,
    /// Its name.
    pub name: String,
    /// Its role.
    pub role: Role,
    /// Maker and type.
    #[schema(required, example = "Cassens & Plath Reflecta 1")]
    pub make: Option<String>,
    /// Its serial number.
    #[schema(required, example = "34871")]
    pub serial_number: Option<String>,
    /// Its binnacle: maker, type and number.
    #[schema(required)]
    pub binnacle: Option<String>,
    /// Time at which it was entered.
    pub created_at: Time,
}

/// Role of a compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = CompassRole)]
pub enum Role {
    /// The standard compass that every ship must carry.
    Standard,
    /// The one at the wheel.
    Steering,
    /// An element that sends its heading elsewhere.
    Transmitting,
}
