//! Order of the movements of a plan.

use super::step::{Corrector, Place};
use crate::adjust::corrector_moves::match_trays;
use crate::adjust::state::MagneticState;
use crate::binnacle::{Axis, Setting, Tray};

/// One movement of a corrector.
pub(crate) struct Movement {
    pub(crate) corrector: Corrector,
    /// Place before; none when it is fitted.
    pub(crate) from: Option<Place>,
    /// Place afterwards; none when it is taken out.
    pub(crate) to: Option<Place>,
    /// Setting of all correctors afterwards.
    pub(crate) setting_after: Setting,
}

impl Movement {
    fn new(corrector: Corrector, [from, to]: [Option<Place>; 2], now: &Setting) -> Movement {
        Movement {
            corrector,
            from,
            to,
            setting_after: now.clone(),
        }
    }
}

/// Arranges the movements from one setting to another in an allowed order.
pub(crate) fn sequence(state: &MagneticState<'_>, from: &Setting, to: &Setting) -> Vec<Movement> {
    let mut all = Vec::new();
    let mut now = from.clone();
    if from.flinders != to.flinders {
        now.flinders.clone_from(&to.flinders);
        let places = [from, to].map(|s| s.flinders.clone().map(Place::Bar));
        all.push(Movement::new(Corrector::Flinders, places, &now));
    }
    if from.quadrantal != to.quadrantal {
        now.quadrantal.clone_from(&to.quadrantal);
        let places = [from, to].map(|s| s.quadrantal.clone().map(Place::Pair));
        all.push(Movement::new(Corrector::Quadrantal, places, &now));
    }
    if from.heeling != to.heeling {
        now.heeling.clone_from(&to.heeling);
        let places = [from, to].map(|s| s.heeling.clone().map(Place::Bucket));
        all.push(Movement::new(Corrector::Heeling, places, &now));
    }
    let mut pending: Vec<(Axis, Option<Tray>, Option<Tray>)> = Vec::new();
    for axis in Axis::BOTH {
        for (old, new) in match_trays(from.trays(axis), to.trays(axis)) {
            if old != new {
                pending.push((axis, old.cloned(), new.cloned()));
            }
        }
    }
    // Magnets that come out make room for others, so they come first.
    pending.sort_by_key(|(axis, _, new)| (*axis, new.is_some()));
    while !pending.is_empty() {
        let possible = pending.iter().position(|(axis, old, new)| {
            let after = replaced(&now, *axis, old.as_ref(), new.as_ref());
            state.binnacle.with_setting(after).is_ok()
        });
        let (axis, old, new) = if let Some(index) = possible {
            pending.remove(index)
        } else {
            let (axis, old, new) = pending.remove(0);
            // Taken out, it makes room for another one, and comes in later.
            pending.push((axis, None, new.clone()));
            if old.is_none() {
                break;
            }
            (axis, old, None)
        };
        now = replaced(&now, axis, old.as_ref(), new.as_ref());
        let corrector = match axis {
            Axis::ForeAndAft => Corrector::ForeAndAft,
            Axis::Athwartship => Corrector::Athwartship,
        };
        let places = [old, new].map(|tray| tray.map(Place::Magnets));
        all.push(Movement::new(corrector, places, &now));
    }
    all
}

fn replaced(now: &Setting, axis: Axis, old: Option<&Tray>, new: Option<&Tray>) -> Setting {
    let mut after = now.clone();
    let trays = after.trays_mut(axis);
    trays.retain(|tray| Some(tray) != old);
    trays.extend(new.cloned());
    trays.sort_by_key(|tray| tray.hole);
    after
}
