//! States of a work order.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// How far an order has come.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type,
)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = WorkOrderState)]
pub enum State {
    /// It was written, and offered to no firm.
    #[default]
    Planned,
    /// A firm is asked.
    Offered,
    /// A firm would have it on other terms: the operator is asked.
    Proposed,
    /// No firm that was asked has taken it.
    Declined,
    /// A firm has it.
    Accepted,
    /// The adjuster is on board.
    OnBoard,
    /// The magnetometer was read at the berth.
    Measured,
    /// A plan was chosen, and its steps are being done.
    Adjusting,
    /// Done; what the compass will show is foretold.
    Adjusted,
    /// Headings at sea agree with what was foretold.
    Verified,
    /// A heading at sea does not agree with it.
    Failed,
    /// Done with.
    Closed,
    /// Done with, though no headings at sea have spoken for or against it.
    ClosedUnverified,
    /// Not to be done, or no further.
    Cancelled,
}

impl State {
    /// Whether the ship's model and binnacle are a firm's business.
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

    /// Whether nothing is to be done any more.
    pub fn is_over(self) -> bool {
        matches!(
            self,
            State::Closed | State::ClosedUnverified | State::Cancelled
        )
    }
}
