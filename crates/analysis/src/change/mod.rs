//! Detection of changes of a vessel's magnetism.
//!
//! A filter like the estimator's runs forward over the rows: the null hypothesis. Beside it
//! runs a bank of filters, each with a jump at an earlier row: of the vessel's magnetism,
//! of a reference's error, or of the earth's field, or with a return to an earlier state. A
//! hypothesis far likelier than the null hypothesis and than a transient is accepted; the
//! row of its jump dates the change (docs/science.md, §9).
//!
//! The decision is taken in `detect/decision.rs`, by the constants of `thresholds` and
//! `priors`.
//!
//! The order in which rows arrive changes nothing. A difference between two references is
//! never attributed to the vessel. Every change has its evidence, and the probabilities of
//! its causes add up to one.

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
pub(crate) use event::{Event, EventKind, RowSpan, Snapshot};
pub(crate) use likelihood_ratio::tempered_odds;
pub(crate) use port_calls::{follows_port_call, rows_since};
pub(crate) use thresholds::SAILED_SINCE_ROWS;
