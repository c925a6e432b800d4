//! Confirmation of the correctors as found, without which nothing is planned.

use crate::work_orders::order_state::OrderState;
use binnacle_adjustment::binnacle::Binnacle;
use binnacle_platform::error::{Error, Result};

/// Refuses a plan before the correctors were confirmed as they stand, or with a defective compass.
///
/// # Errors
/// [`Error::WrongState`].
pub(crate) fn require_as_found(state: &OrderState) -> Result<()> {
    let Some(found) = &state.as_found else {
        return Err(Error::WrongState(
            "the correctors are not confirmed as they stand: report each one's place, red end and \
                pieces, and the checks alongside, under as-found"
                .to_owned(),
        ));
    };
    let defects = found.dockside.defects();
    if defects.is_empty() {
        return Ok(());
    }
    Err(Error::WrongState(format!(
        "the compass must be repaired before planning: {}; then report it again under as-found",
        defects.join("; ")
    )))
}

/// Refuses a reading by a record of the correctors that was changed after they were confirmed.
///
/// # Errors
/// [`Error::WrongState`].
pub(crate) fn require_record_as_found(state: &OrderState, recorded: &Binnacle) -> Result<()> {
    let found = state.as_found.as_ref();
    if found.is_none_or(|found| found.setting == recorded.setting) {
        return Ok(());
    }
    Err(Error::WrongState(
        "the record of the correctors was changed after they were confirmed as they stand: \
            report them again under as-found"
            .to_owned(),
    ))
}
