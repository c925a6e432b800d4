//! Changes of the result: detected and suspected events, and work in the logbook.

mod collect;
mod detected;
mod evidence;
mod logged_work;
mod size;

pub(super) use collect::{Findings, changes};
