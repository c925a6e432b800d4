//! Changes of a ship's magnetism, and what only looks like one.
//!
//! A filter like the estimator's runs forward over the rows. Beside it runs a bank
//! of copies, each of which supposes that something happened at a time: that the
//! ship's magnetism changed, that a reference did, that the earth's field went
//! astray for hours, or that the ship is again as she was. A copy that explains the
//! rows far better than the filter, and than a passing disturbance would, is
//! believed; the time it began from dates the change (docs/science.md, §9).
//!
//! What always holds: the rows' order of arrival changes nothing; a difference
//! between two references is never put down to the ship; every change says by what
//! evidence, and the probabilities of its causes add up to one.

mod bank;
mod calls;
mod cause;
mod detect;
mod filter;
mod large;
mod symmetric;
mod upset;

pub(crate) use cause::{Circumstances, causes, odds};
pub(crate) use detect::{
    Event, Given, Loaded, Perhaps, SAILED_SINCE, Snapshot, Unnoticed, What, at_port, detect,
    rows_since,
};
