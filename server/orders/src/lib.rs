//! Adjusters' firms and work orders, from the offer to the evidence.

#![allow(
    clippy::missing_errors_doc,
    reason = "a function that asks the database errs when that does; others say more"
)]
#![allow(
    clippy::cast_possible_wrap,
    reason = "counts go into BIGINT and are far from its end"
)]

pub mod api;
pub mod berth_session;
pub mod completion;
pub mod dispatch;
pub mod event_kinds;
pub mod evidence;
pub mod firms;
pub mod verification;
pub mod work_orders;
