//! Why a compass has no model, and since when its last one holds no more.

use crate::analysis::LeftOut;
use binnacle_magnetics::fit::FitError;
use binnacle_wire::messages::CardWithdrawn;
use std::fmt;

/// What there is to say in place of a model.
#[derive(Clone, Debug)]
pub struct NoModel {
    /// Why the samples make none; without a reason, none has been analysed.
    pub refusal: Option<FitError>,
    /// The samples that the logbook leaves out.
    pub left_out: LeftOut,
    /// That there was one, and it must not be used.
    pub card_withdrawn: Option<CardWithdrawn>,
}

impl fmt::Display for NoModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(withdrawn) = &self.card_withdrawn {
            write!(f, "{withdrawn}: ")?;
        }
        match &self.refusal {
            Some(refusal) => write!(f, "{refusal}{}", self.left_out),
            None => f.write_str("no samples have been analysed yet"),
        }
    }
}
