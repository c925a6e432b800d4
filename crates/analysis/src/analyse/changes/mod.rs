//! Changes found among the readings of one epoch of the logbook: the epochs that
//! they make of it, and what they say of its samples.

mod change_size;
mod evidence;
mod find;
mod findings;
mod reference_faults;
mod report;

pub(super) use change_size::sharpen;
pub(super) use find::find;
pub(super) use findings::{Begun, Ended, Found, Known, MISTIMED_S, Misled};
pub(super) use reference_faults::merge_faults;
