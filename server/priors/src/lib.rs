//! Priors: publication of what a fleet's vessels say of a new one, and the prior of each
//! compass.
//!
//! Invariants:
//!
//! - A prior is made of vessels of the same operator alone, and never of the vessel itself.
//! - A class is published at most once in 30 days. A publication never changes.
//! - A compass keeps the prior that it was derived with, until another estimator derives it anew.
//! - A class that is too small is named, and the next larger one used: sister ships, the
//!   operator's fleet, the population.
//! - Only compasses of the same role inform each other.

#![allow(
    clippy::missing_errors_doc,
    reason = "a function that asks the database errs when that does; others say more"
)]
#![allow(
    clippy::cast_possible_wrap,
    reason = "counts go into BIGINT and are far from its end"
)]

mod api;
mod choose;
mod evidence;
mod publications;
mod vessel_priors;

pub use api::router;
pub use choose::find_or_choose;
pub use vessel_priors::{RefusedClass, VesselPrior};
