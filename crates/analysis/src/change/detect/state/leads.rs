//! The likeliest hypothesis of each kind.

use crate::change::hypotheses::Lead;

/// The likeliest copies by kind, in the order of [`HypothesisKind`].
pub(crate) type Leads = [Option<Lead>; 4];
