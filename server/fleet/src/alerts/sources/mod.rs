//! Sources of alerts. Each reconciles a compass's alerts with facts of one kind.

mod agent_alerts;
mod analysis;
mod duplicate_agent;
mod job_at_risk;
mod timed;

pub use agent_alerts::record_agent_alerts;
pub use analysis::reconcile_analysis;
pub use duplicate_agent::{check_duplicate_agent, end_duplicate_agent};
pub use job_at_risk::reconcile_jobs_at_risk;
pub use timed::{check_silence, check_timed, watch};
