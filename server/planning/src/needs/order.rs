//! Work order that meets a need.

use binnacle_orders::work_orders::State;
use binnacle_platform::ids::OrderId;
use binnacle_platform::time::Time;
use serde::Serialize;
use utoipa::ToSchema;

/// Open work order of a compass.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = NeedOrder)]
pub struct OpenOrder {
    /// The order.
    pub id: OrderId,
    /// State of the order.
    pub state: State,
    /// Port, as the operator wrote it or as its UN/LOCODE.
    #[schema(example = "NLRTM")]
    pub port: String,
    /// Beginning of the work as agreed or proposed.
    pub from: Time,
    /// End of the work.
    pub until: Time,
}
