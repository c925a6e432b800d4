//! Planning of adjustments: port calls, needs and the schedule, with calendars, notifications and
//! reports.

#![allow(
    clippy::missing_errors_doc,
    reason = "functions fail when the database does; others document their errors"
)]
#![allow(
    clippy::cast_possible_wrap,
    reason = "counts are far below the limit of BIGINT"
)]

pub mod event_kinds;
pub mod needs;
pub mod port_calls;
pub mod schedule;
mod schedule_settings;

pub mod calendar;
pub mod notifications;
pub mod reports;
