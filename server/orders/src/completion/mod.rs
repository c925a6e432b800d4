//! Completion of a work order: the signed record, its evidence, and completed orders.

pub mod complete;
mod completed_orders;
pub(crate) mod completion_api;
mod record;
mod sign_off;

pub use completed_orders::{CompletedOrder, CompletionPeriod, completed_orders};
