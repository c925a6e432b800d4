//! Creation of an order.

use crate::work_orders::events::event::Event;
use crate::work_orders::new_order::NewOrder;
use crate::work_orders::order_state::OrderState;
use serde::{Deserialize, Serialize};

/// Order as it was created.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Opened {
    /// The request.
    #[serde(flatten)]
    pub order: NewOrder,
    /// Name of the vessel at that time.
    pub vessel_name: String,
    /// Name of the compass at that time.
    pub compass_name: String,
}

impl Event for Opened {
    fn apply(&self, state: &mut OrderState) {
        state.limits = self.order.limits.unwrap_or_default();
        state.hours = Some(self.order.hours());
    }
}
