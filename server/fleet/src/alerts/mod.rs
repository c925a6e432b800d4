//! Alerts: conditions of a compass that people must know, from the first sign to the end.
//!
//! Invariants:
//!
//! - An alert is raised, acknowledged and cleared, and kept for good. A compass has one open
//!   alert of each cause, which is updated while the cause goes on.
//! - An alert clears itself when its cause is over. One that a person cleared comes back only
//!   when its cause does, gets worse, or happens again.
//! - An alert is about one event. Another event of its cause clears it, with the remarks on it,
//!   and raises the next.
//! - A vessel out of service has no open alert.
//! - An alert changes in the transaction that stores the facts: an analysis, a batch or a
//!   schedule. The clock finds silence.
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
mod publish;
mod reconcile;
mod schema;
mod sources;
mod store;

pub use after_adjustment::list_in_force;
pub use alert::{Alert, Evidence, State};
pub use api::router;
pub use cause::Cause;
pub use causes::{Effect, JobAtRisk, UnconfirmedAdjustment};
pub use reconcile::end_all;
pub use sources::{
    check_duplicate_agent, check_silence, check_timed, end_duplicate_agent, reconcile_analysis,
    reconcile_jobs_at_risk, record_agent_alerts, watch,
};
pub use store::{OpenAlert, OpenCount, count_open, summarize};
