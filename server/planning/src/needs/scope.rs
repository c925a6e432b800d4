//! Scope of a query for needs: vessels, and keys of their compasses.

use binnacle_platform::ids::{CompassId, OperatorId, VesselId};

/// Vessel and compass: the key of what is stored of a compass.
pub(super) type CompassKey = (VesselId, CompassId);

/// Vessels of an operator in a range of ids.
#[derive(Clone, Copy)]
pub(super) struct Which {
    pub(super) operator: OperatorId,
    pub(super) first: VesselId,
    pub(super) last: VesselId,
}
