//! Changes found among the readings of one epoch of the logbook, the epochs that they
//! begin, and the samples that they spoil.

mod change_size;
mod evidence;
mod find;
mod findings;
mod reference_faults;
mod report;

pub(super) use change_size::refine_size;
pub(super) use find::find_changes;
pub(super) use findings::{
    ChangeFindings, MISTIMED_S, PossibleAlignment, PossibleEnd, PossibleStart, PriorKnowledge,
};
pub(super) use reference_faults::merge_faults;
