//! Adjustment at the berth without a swing: from the model, one magnetometer reading and
//! the binnacle's correctors to settings, predictions and instructions.
//!
//! The ship without correctors is the measured ship less the effect of its correctors. Any
//! other setting is then applied to it with all interactions (docs/science.md, §11).
//! Invariants: a plan uses only correctors on board. Its predictions carry the joint errors
//! of model, λ and correctors. Where these are too large, the result is a refusal with
//! possible cures instead of a plan. Nothing here is a certificate.

mod inputs;
mod needle_part;

mod diagnosis;

mod corrector_moves;
mod state;

mod heeling;
mod prediction;
mod search;

mod limit_violations;

mod instructions;
mod planning;

mod as_found;
mod step_check;

mod post_check;

mod verification;

pub use diagnosis::{
    CardCheck, Coefficient, Cure, LambdaComparison, Misreading, Refusal, Refused, find_misreadings,
};
pub use heeling::HeelingPlan;
pub use inputs::{
    AdjustError, Adjustment, Berth, BerthForm, Circumstances, EarlierLambda, FieldForm, FormError,
    HeadingFrom, Limits, Magnetometer, NumberError, PostCheckForm, ReadingForm, SecondReadingForm,
    ShiftedReading, Unit, VerticalReading, Water, WaterForm,
};
pub use instructions::{Action, Corrector, Place, Step};
pub use planning::{BerthCheck, HeadingVisibility, Outcome, Plan, SecondHeading, plan};
pub use post_check::{
    CompletedStep, FieldComponent, PostCheck, Slip, UpdatedPrediction, Verdict,
    check_second_reading, predict_by_compass,
};
pub use prediction::{PredictedRow, PredictedTable};
pub use search::Optimality;
pub use step_check::{
    ProvenEffect, StepCheck, TotalTurn, check_step, check_step_with_setting, check_total_turn,
};
pub use verification::{NeededHeadings, SettledHeading, Verification, verify};

#[cfg(test)]
pub(crate) mod tests;
