//! Adjusting at the berth, without a swing: from the model, one magnetometer reading
//! and the binnacle's correctors to settings, predictions and instructions.
//!
//! The ship herself is what was measured less what the correctors did then; any other
//! setting is put to her with all its interactions (docs/science.md, §11). What always
//! holds: a plan uses only what is on board, its predictions carry the errors of model,
//! λ and correctors together, and where that is not good enough there is no plan but a
//! refusal that says what would cure it. Nothing here is a certificate.

mod inputs;

mod diagnosis;

mod corrector_moves;
mod state;

mod heeling;
mod prediction;
mod search;

mod limit_violations;

mod instructions;
mod planning;

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
    Unit, VerticalReading, Water, WaterForm,
};
pub use instructions::{Action, Corrector, Place, Step};
pub use planning::{BerthCheck, HeadingVisibility, Outcome, Plan, plan};
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
