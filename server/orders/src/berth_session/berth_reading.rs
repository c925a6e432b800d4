//! Check of the reading at the berth.
//!
//! Invariants: a refused reading is kept with the reason. An accepted reading is kept with
//! everything that a plan from it depends on, so that the plan can be repeated from the log alone.
//! The field names are those of `plan` (docs/plan.md).

use crate::work_orders::payload::plan_basis::Basis;
use crate::work_orders::payload::recorded_reading::BerthCheck;
use crate::work_orders::refusal::Refusal;
use binnacle_adjustment::adjust::ReadingForm;
use binnacle_adjustment::berth::{BerthEstimate, BerthReading};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::time::Time;

/// Largest lead of a clock on board over the server's, seconds.
const MAX_CLOCK_LEAD_S: f64 = 300.0;

/// Refuses values outside their ranges, and a time in the future.
pub(crate) fn check_reading_ranges(given: &ReadingForm, now: Time) -> Result<()> {
    given.check_ranges().map_err(|error| Error::Invalid {
        field: error.field,
        detail: error.what,
    })?;
    if given.at.seconds_since(now.0) > MAX_CLOCK_LEAD_S {
        return Err(Error::Invalid {
            field: "at",
            detail: "lies in the future".to_owned(),
        });
    }
    Ok(())
}

/// Checks a reading against its basis; returns the check, or the refusal.
pub(crate) fn check(
    given: &ReadingForm,
    basis: &Basis,
) -> Result<std::result::Result<BerthCheck, Refusal>> {
    let variation = basis.variation()?;
    let checked = given.check(
        &basis.model.model,
        basis.earth(),
        variation,
        &basis.binnacle,
    );
    Ok(match checked {
        Ok((reading, estimate)) => Ok(BerthCheck::new(&reading, &estimate)),
        Err(refused) => Err(Refusal::from(&*refused)),
    })
}

impl BerthCheck {
    fn new(reading: &BerthReading, estimate: &BerthEstimate) -> BerthCheck {
        let (lambda, consistency) = (estimate.lambda, estimate.consistency);
        BerthCheck {
            lambda: lambda.value,
            lambda_sd: lambda.standard_error,
            consistency_deg: consistency.angle_deg,
            consistency_sd_deg: consistency.standard_error_deg,
            verdict: consistency.verdict.to_string(),
            magnetic_deg: reading.magnetic().degrees(),
        }
    }
}
