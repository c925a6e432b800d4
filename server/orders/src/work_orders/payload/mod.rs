//! Payloads of events that the state of an order keeps.

pub(crate) mod as_found;
pub(crate) mod chosen_plan;
pub(crate) mod exchange;
pub(crate) mod hours;
pub(crate) mod photograph;
pub(crate) mod plan_basis;
pub(crate) mod port_call;
pub(crate) mod recorded_reading;
pub(crate) mod recorded_second_reading;
pub(crate) mod sea_verification;
pub(crate) mod signed_record;
pub(crate) mod step_result;
