//! A large step that is neither certain nor out of question when the rows end.
//!
//! What always holds: it is no event; until the rows tell, the band is to hold both the ship
//! that she was and the one that she may be.

use super::{Leads, Search};
use crate::change::bank::Kind;
use crate::change::cause::odds;
use crate::estimate::POPULATION_SD;

/// A smaller step than this leaves the band as it is, population units (1500 nT).
const LARGE: f64 = 1.0;
/// One must be likelier by this than nothing, nats.
const WORTH_NATS: f64 = 5.0;
/// And is out of question when something else is likelier by this.
const OUT_OF_QUESTION_NATS: f64 = 25.0;
/// Until then it is held to be no less likely than this: the ship goes aground by the band
/// that is too narrow.
const AT_LEAST: f64 = 0.3;

impl Search<'_> {
    /// What the step that may have been adds to the variance of bx and by, nT².
    pub(super) fn open_nt2(&self, leads: &Leads) -> Option<f64> {
        let step = leads[Kind::Step as usize].filter(|step| step.nats > WORTH_NATS)?;
        let others = leads.iter().flatten().map(|lead| lead.nats);
        let behind = others.fold(0.0, f64::max) - step.nats;
        let spawn = &self.bank.spawns[step.spawn];
        let size = spawn.copy(step.kind)?.far_from(spawn.origin());
        if size < LARGE || behind > OUT_OF_QUESTION_NATS {
            return None;
        }
        let probability = (1.0 / (1.0 + odds(behind))).max(AT_LEAST);
        Some(probability * (size * POPULATION_SD[0]).powi(2))
    }
}
