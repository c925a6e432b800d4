//! Alerts: conditions of a compass that people must know of, from the first sign to the end.
//!
//! Invariants:
//!
//! - An alert is raised, acknowledged and cleared, and never deleted. A compass has at most one
//!   open alert of each cause, which is updated while the cause lasts.
//! - An alert clears itself when its cause is over. One that a person cleared is raised again only
//!   when its cause recurs or gets worse.
//! - An alert is about one event. Another event of the same cause clears it and raises a new one.
//! - A vessel out of service has no open alert.
//! - An alert changes in the transaction that stores the facts: an analysis, a batch or a schedule.
//!   A timer detects silence.
//! - Every change is stored together with its announcements.

mod after_adjustment;
mod alert;
mod announcement;
mod api;
mod cause;
mod causes;
mod change;
mod clearing;
mod desired;
mod handling;
pub mod message_kinds;
mod publish;
mod reconcile;
mod requests;
mod sources;
mod store;

pub use after_adjustment::list_in_force;
pub use alert::{Alert, Evidence, State};
pub use announcement::{AlertMessage, NOTICE_KIND, TOPIC_LIST};
pub use api::router;
pub use cause::Cause;
pub use causes::{CardEffect, JobAtRisk, PlanEffect, UnconfirmedAdjustment};
pub use reconcile::end_all;
pub use sources::{
    check_duplicate_agent, check_silence, check_timed, end_duplicate_agent, reconcile_analysis,
    reconcile_jobs_at_risk, record_agent_alerts, watch,
};
pub use store::{OpenAlert, OpenCount, count_open, summarize};
