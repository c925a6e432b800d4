//! Arrival of the adjuster on board.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::notice_kinds;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::state::State;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Arrival of the adjuster on board.
#[derive(Clone, Debug, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = OnBoard, example = json!({ "text": "Gangway on the starboard side." }))]
pub(crate) struct Boarding {
    /// Time of arrival; now by default.
    #[serde(default)]
    pub at: Option<Time>,
    /// Text.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub text: Option<String>,
}

impl Event for Boarding {
    fn apply(&self, state: &mut OrderState) {
        state.offers.drop_retime();
        state.state = State::OnBoard;
    }

    fn operator_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        Some(Headline::new(
            notice_kinds::ON_BOARD,
            "the adjuster is on board",
        ))
    }

    fn changes_offers(&self) -> bool {
        true
    }
}
