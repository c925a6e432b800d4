//! Planning of adjustments: port calls, needs, the schedule, and what people hear of it.

#![allow(
    clippy::missing_errors_doc,
    reason = "a function that asks the database errs when that does; others say more"
)]
#![allow(
    clippy::cast_possible_wrap,
    reason = "counts go into BIGINT and are far from its end"
)]

pub mod needs;
pub mod port_calls;
pub mod schedule;
mod schedule_settings;

pub mod calendar;
pub mod notifications;
pub mod reports;
