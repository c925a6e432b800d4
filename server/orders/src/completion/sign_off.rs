//! Sign-off of an adjustment by the adjuster.

use crate::berth_session::steps::require_after_last_step;
use crate::work_orders::store::StoredOrder;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::{optional_text, text};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Sign-off of an adjustment.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = Completion, example = json!({
    "adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114",
    "firm": "Nervión Compass", "signature": "M. Etxeberria"
}))]
pub(crate) struct SignOff {
    /// Time of the adjustment; now by default.
    #[serde(default)]
    pub at: Option<Time>,
    /// The adjuster.
    #[schema(min_length = 1, max_length = 200)]
    pub adjuster_name: String,
    /// Licence number.
    #[schema(min_length = 1, max_length = 200)]
    pub adjuster_licence: String,
    /// Firm of the adjuster.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub firm: Option<String>,
    /// The adjuster's name once more, typed as a signature.
    #[schema(min_length = 1, max_length = 200)]
    pub signature: String,
}

impl SignOff {
    /// Validates the sign-off; returns it with the time of the adjustment.
    pub(crate) fn checked(self, stored: &StoredOrder, now: Time) -> Result<(SignOff, Time)> {
        let state = stored.state();
        let at = self.at.unwrap_or(now);
        let second = state.second_reading.as_ref().map(|second| second.given.at);
        let read = state.reading.as_ref().map(|read| read.given.at);
        let read_at = second.or(read).map(Time);
        if at > now || read_at.is_some_and(|read_at| at < read_at) {
            return Err(Error::Invalid {
                field: "at",
                detail: "lies in the future, or before the last reading at the berth".to_owned(),
            });
        }
        require_after_last_step(stored, at)?;
        let sign_off = SignOff {
            at: Some(at),
            adjuster_name: text("adjuster_name", &self.adjuster_name)?,
            adjuster_licence: text("adjuster_licence", &self.adjuster_licence)?,
            firm: optional_text("firm", self.firm.as_deref())?,
            signature: text("signature", &self.signature)?,
        };
        if sign_off.signature.to_lowercase() != sign_off.adjuster_name.to_lowercase() {
            return Err(Error::Invalid {
                field: "signature",
                detail: "is not the adjuster's name".to_owned(),
            });
        }
        Ok((sign_off, at))
    }
}
