//! A calendar feed and its scope.

use binnacle_platform::ids::{FeedId, VesselId};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use serde::Serialize;
use utoipa::ToSchema;

/// Calendar feed that programs subscribe to.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = CalendarFeed)]
pub(super) struct Feed {
    /// Id of the feed.
    pub(super) id: FeedId,
    /// Name of the feed.
    #[schema(example = "Nao Victoria")]
    pub(super) name: String,
    /// The vessel, if the feed is limited to one.
    #[schema(required)]
    pub(super) vessel_id: Option<VesselId>,
    /// Time of creation.
    pub(super) created_at: Time,
    /// Name of its creator.
    pub(super) created_by: String,
}

/// Scope of a calendar: the tenant whose appointments it shows, or one vessel's of them.
pub(super) struct Scope {
    /// Name of the calendar.
    pub(super) name: String,
    pub(super) tenant: Tenant,
    pub(super) vessel: Option<VesselId>,
}
