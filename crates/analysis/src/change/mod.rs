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

mod cause;
mod detect;
mod detection;
mod event;
mod filter;
mod hypotheses;
mod hypothesis_kind;
mod jump_models;
mod large_step;
mod likelihood_ratio;
mod port_call_returns;
mod port_calls;
mod priors;
mod thresholds;

pub(crate) use cause::{Circumstances, causes};
pub(crate) use detect::detect;
pub(crate) use detection::{CargoPeriod, DetectionInput, PossibleReturn, UndetectedStep};
pub(crate) use event::{Event, EventKind, Snapshot};
pub(crate) use likelihood_ratio::tempered_odds;
pub(crate) use port_calls::{at_port, rows_since};
pub(crate) use thresholds::SAILED_SINCE_ROWS;
