//! States of a work order.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// State of an order.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type,
)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = WorkOrderState)]
pub enum State {
    /// Written, and offered to no firm.
    #[default]
    Planned,
    /// An offer to a firm is open.
    Offered,
    /// A firm has proposed other terms, which await the operator's answer.
    Proposed,
    /// No firm accepted its offer.
    Declined,
    /// A firm has the order.
    Accepted,
    /// The adjuster is on board.
    OnBoard,
    /// The magnetometer was read at the berth.
    Measured,
    /// A plan was chosen, and its steps are being done.
    Adjusting,
    /// Completed; the deviations are predictions.
    Adjusted,
    /// Headings at sea agree with the prediction.
    Verified,
    /// A heading at sea contradicts the prediction.
    Failed,
    /// Closed.
    Closed,
    /// Closed without verification by headings at sea.
    ClosedUnverified,
    /// Cancelled, before or during the work.
    Cancelled,
}

impl State {
    /// Returns whether the adjustment is still to be completed: a firm may read the model and
    /// binnacle.
    pub fn is_under_way(self) -> bool {
        matches!(
            self,
            State::Planned
                | State::Offered
                | State::Proposed
                | State::Declined
                | State::Accepted
                | State::OnBoard
                | State::Measured
                | State::Adjusting
        )
    }

    /// Returns whether nothing remains to be done.
    pub fn is_over(self) -> bool {
        matches!(
            self,
            State::Closed | State::ClosedUnverified | State::Cancelled
        )
    }
}
