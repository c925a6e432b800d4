//! Places of correctors in a setting.

use super::step::{Corrector, Place, Step};
use crate::binnacle::{Axis, Setting, Tray};

/// Returns the place with the red end reversed; `None` for correctors without ends.
pub(crate) fn reversed(place: &Place) -> Option<Place> {
    match place {
        Place::Magnets(tray) => {
            let mut tray = tray.clone();
            tray.red = tray.red.reversed();
            Some(Place::Magnets(tray))
        }
        Place::Bucket(set) => {
            let mut set = set.clone();
            set.red = set.red.reversed();
            Some(Place::Bucket(set))
        }
        Place::Pair(_) | Place::Bar(_) => None,
    }
}

/// Returns the place moved up by some holes, with the new hole's number.
pub(crate) fn moved(place: &Place, by: i32) -> Option<(Place, u16)> {
    let other = |hole: u16| u16::try_from(i32::from(hole) + by).ok();
    match place {
        Place::Magnets(tray) => {
            let mut tray = tray.clone();
            tray.hole = other(tray.hole)?;
            let hole = tray.hole;
            Some((Place::Magnets(tray), hole))
        }
        Place::Bucket(set) => {
            let mut set = set.clone();
            set.position = other(set.position)?;
            let position = set.position;
            Some((Place::Bucket(set), position))
        }
        Place::Pair(_) | Place::Bar(_) => None,
    }
}

fn axis_of(corrector: Corrector) -> Option<Axis> {
    match corrector {
        Corrector::ForeAndAft => Some(Axis::ForeAndAft),
        Corrector::Athwartship => Some(Axis::Athwartship),
        _ => None,
    }
}

pub(crate) fn stands(setting: &Setting, corrector: Corrector, place: &Place) -> bool {
    match place {
        Place::Magnets(tray) => {
            axis_of(corrector).is_some_and(|axis| setting.trays(axis).contains(tray))
        }
        Place::Pair(pair) => setting.quadrantal.as_ref() == Some(pair),
        Place::Bar(bar) => setting.flinders.as_ref() == Some(bar),
        Place::Bucket(set) => setting.heeling.as_ref() == Some(set),
    }
}

/// Finds the place of a similar corrector in a setting that is not in the other setting.
pub(crate) fn elsewhere(
    setting: &Setting,
    corrector: Corrector,
    place: &Place,
    other: &Setting,
) -> Option<Place> {
    match place {
        Place::Magnets(was) => {
            let axis = axis_of(corrector)?;
            let could_be =
                |tray: &&Tray| tray.magnet == was.magnet && !other.trays(axis).contains(tray);
            let tray = setting.trays(axis).iter().find(could_be);
            tray.cloned().map(Place::Magnets)
        }
        Place::Pair(_) => setting.quadrantal.clone().map(Place::Pair),
        Place::Bar(_) => setting.flinders.clone().map(Place::Bar),
        Place::Bucket(_) => setting.heeling.clone().map(Place::Bucket),
    }
}

/// Returns the setting with one place replaced.
pub(crate) fn replaced(
    setting: &Setting,
    corrector: Corrector,
    old: Option<&Place>,
    new: Option<&Place>,
) -> Setting {
    let mut other = setting.clone();
    match corrector {
        Corrector::ForeAndAft | Corrector::Athwartship => {
            let Some(axis) = axis_of(corrector) else {
                return other;
            };
            let trays = other.trays_mut(axis);
            if let Some(Place::Magnets(old)) = old {
                trays.retain(|tray| tray != old);
            }
            if let Some(Place::Magnets(new)) = new {
                trays.push(new.clone());
            }
            trays.sort_by_key(|tray| tray.hole);
        }
        Corrector::Flinders => {
            other.flinders = match new {
                Some(Place::Bar(bar)) => Some(bar.clone()),
                _ => None,
            };
        }
        Corrector::Quadrantal => {
            other.quadrantal = match new {
                Some(Place::Pair(pair)) => Some(pair.clone()),
                _ => None,
            };
        }
        Corrector::Heeling => {
            other.heeling = match new {
                Some(Place::Bucket(set)) => Some(set.clone()),
                _ => None,
            };
        }
    }
    other
}

impl Step {
    /// Returns true when the moved corrector is in its intended place by the setting
    /// `taken`, but not by the setting `said`.
    pub fn is_contradicted(&self, taken: &Setting, said: &Setting) -> bool {
        let is_done = |setting: &Setting| match (&self.to, &self.from) {
            (Some(to), _) => stands(setting, self.corrector, to),
            (None, Some(from)) => !stands(setting, self.corrector, from),
            (None, None) => true,
        };
        is_done(taken) && !is_done(said)
    }
}
