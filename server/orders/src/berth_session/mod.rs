//! The adjuster's session at the berth: readings, plans, steps and photographs.

mod as_found;
pub(crate) mod berth_api;
pub(crate) mod berth_reading;
pub(crate) mod firm_vessel_view;
pub mod photos;
pub(crate) mod plan;
pub(crate) mod plan_slots;
mod planning_inputs;
mod position_check;
mod previous_lambda;
pub(crate) mod second_reading;
pub(crate) mod second_reading_api;
pub(crate) mod steps;

pub use berth_api::BerthHeadingRead;
pub use plan_slots::CorrectorPlanSlots;
