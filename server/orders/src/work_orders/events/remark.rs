//! Remark on an order.

use crate::work_orders::events::event::Event;
use crate::work_orders::order_state::OrderState;
use serde::{Deserialize, Serialize};

/// Remark on an order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Remark {
    /// Text of the remark.
    pub text: String,
}

impl Event for Remark {
    fn apply(&self, _state: &mut OrderState) {}
}
