//! A notification and the filter of a list.

use super::kinds::NoticeKinds;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{AlertId, NotificationId, OrderId, VesselId};
use binnacle_platform::notices::Kind;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// Notification of an event that concerns you.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
pub(super) struct Notification {
    /// The notification's id.
    pub(super) id: NotificationId,
    /// Kind of event.
    #[schema(value_type = Kind)]
    pub(super) kind: String,
    /// `true` when its mail skips quiet hours and digests.
    pub(super) urgent: bool,
    /// Subject line.
    #[schema(example = "Nao Victoria: Nervión Compass accepts the adjustment at Bilbao")]
    pub(super) subject: String,
    /// Full text, as in mail.
    pub(super) text: String,
    /// Page of the dashboard that shows it.
    #[schema(example = "/work-orders/0199aa00-0000-7000-8000-000000000001")]
    pub(super) path: String,
    /// The vessel.
    #[schema(required)]
    pub(super) vessel_id: Option<VesselId>,
    /// The work order, if it concerns one.
    #[schema(required)]
    pub(super) order_id: Option<OrderId>,
    /// The alert, if it concerns one.
    #[schema(required)]
    pub(super) alert_id: Option<AlertId>,
    /// Time of the event.
    pub(super) created_at: Time,
    /// Time at which you marked it as read.
    #[schema(required)]
    pub(super) read_at: Option<Time>,
}

/// Filter of a list of notifications.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Filter {
    /// Only unread ones (`true`) or only read ones (`false`).
    pub(super) unread: Option<bool>,
    /// Only of this kind.
    #[param(value_type = Option<Kind>)]
    pub(super) kind: Option<String>,
}

impl Filter {
    /// Checks the name of the kind.
    ///
    /// # Errors
    /// Fails when there is no such kind.
    pub(super) fn check(&self, kinds: &NoticeKinds) -> Result<()> {
        let Some(Err(problem)) = self.kind.as_deref().map(|name| kinds.find(name)) else {
            return Ok(());
        };
        let detail = format!("Failed to deserialize query string: kind: {problem}");
        Err(Error::BadRequest(detail))
    }
}
