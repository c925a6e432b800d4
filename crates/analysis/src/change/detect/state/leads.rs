//! Leading hypotheses.

use crate::change::hypotheses::Lead;

/// Leading step, reference's step, transient and return, in the order of
/// `HypothesisKind`.
pub(crate) type Leads = [Option<Lead>; 4];
