//! Changes of the result: detected and suspected events, and work in the logbook.

mod collect;
mod detected;
mod disturbed;
mod evidence;
mod logged_work;
mod size;

pub(super) use collect::{Changes, Findings, changes};
pub(super) use disturbed::record_disturbed;
