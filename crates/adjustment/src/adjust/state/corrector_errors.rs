//! Errors of correctors relative to the formulas.
//!
//! Each error is an effect of one standard deviation, independent of the others. Only moved
//! correctors count: the effect of an unmoved one is part of the measured ship. The magnets
//! of a tray have a common error; moved from one hole to another, they have the difference.

use crate::adjust::corrector_moves::match_trays;
use crate::binnacle::{Axis, Binnacle, Setting, Soft, Tray};
use crate::corrector::{Effect, Iron, NEEDLE_SD, heeling_effect, tray_effect};

/// Returns the errors of a change from the binnacle's own setting to another.
pub(crate) fn setting_errors(binnacle: &Binnacle, to: &Setting) -> Vec<Effect> {
    errors_between(binnacle, &binnacle.setting, to)
}

pub(crate) fn errors_between(binnacle: &Binnacle, from: &Setting, to: &Setting) -> Vec<Effect> {
    let mut errors = Vec::new();
    let irons = [from, to].map(|setting| Iron::new(binnacle, &setting.soft()));
    for axis in Axis::BOTH {
        for (old, new) in match_trays(from.trays(axis), to.trays(axis)) {
            if old != new {
                errors.extend(magnets(binnacle, &irons, axis, old, new));
            }
        }
    }
    if from.heeling != to.heeling {
        errors.push(heeling(binnacle, &irons, from, to));
    }
    errors.extend(pair(binnacle, from, to));
    errors.extend(bar(binnacle, from, to));
    errors
}

fn magnets(
    binnacle: &Binnacle,
    irons: &[Iron; 2],
    axis: Axis,
    old: Option<&Tray>,
    new: Option<&Tray>,
) -> Vec<Effect> {
    let one = |tray: Option<&Tray>, iron: &Iron| {
        tray.map(|tray| {
            let effect = tray_effect(binnacle, iron, axis, tray);
            let (moment_sd, place_sd) = tray_sd(binnacle, axis, tray);
            (effect.times(moment_sd), effect.times(place_sd))
        })
    };
    let (old_errors, new_errors) = (one(old, &irons[0]), one(new, &irons[1]));
    let same_magnets = old
        .zip(new)
        .is_some_and(|(old, new)| old.magnet == new.magnet && old.count == new.count);
    let mut errors = Vec::new();
    match (&old_errors, &new_errors) {
        (Some((old, _)), Some((new, _))) if same_magnets => errors.push(new.less(old)),
        _ => errors.extend(
            [&old_errors, &new_errors]
                .into_iter()
                .flatten()
                .map(|(m, _)| *m),
        ),
    }
    errors.extend(
        [&old_errors, &new_errors]
            .into_iter()
            .flatten()
            .map(|(_, place)| *place),
    );
    errors
}

/// Returns the relative standard deviations of a tray's moment and position.
fn tray_sd(binnacle: &Binnacle, axis: Axis, tray: &Tray) -> (f64, f64) {
    if let Some(measured) = binnacle.calibrated_magnet(axis, &tray.magnet, tray.hole) {
        return (measured.sd, 0.0);
    }
    let kind = binnacle.design.magnet(&tray.magnet);
    let moment = kind.map(|kind| binnacle.moment(kind));
    let rack = binnacle.design.rack(axis);
    let (Some(moment), Some(hole)) = (moment, rack.hole(tray.hole)) else {
        return (0.0, 0.0);
    };
    let depth_mm = hole.below_card_mm;
    let squared = depth_mm.powi(2) + rack.off_centre_mm.powi(2) + moment.length_mm.powi(2) / 4.0;
    (moment.sd, 3.0 * depth_mm * rack.position_sd_mm / squared)
}

fn heeling(binnacle: &Binnacle, irons: &[Iron; 2], from: &Setting, to: &Setting) -> Effect {
    let one = |setting: &Setting, iron: &Iron| {
        let set = setting.heeling.as_ref();
        set.map_or_else(Effect::default, |set| heeling_effect(binnacle, iron, set))
    };
    let bucket = binnacle.design.heeling.as_ref();
    let kind = bucket.and_then(|bucket| binnacle.design.magnet(&bucket.magnet));
    let sd = kind.map_or(0.0, |kind| binnacle.moment(kind).sd);
    one(to, &irons[1]).less(&one(from, &irons[0])).times(sd)
}

fn pair(binnacle: &Binnacle, from: &Setting, to: &Setting) -> Vec<Effect> {
    if from.quadrantal == to.quadrantal {
        return Vec::new();
    }
    let one = |setting: &Setting| {
        let set = setting.quadrantal.as_ref()?;
        let sizes = binnacle.design.quadrantal.as_ref()?.sizes.iter();
        let size = sizes.clone().find(|size| size.name == set.size)?;
        let soft = Soft {
            quadrantal: Some(set.clone()),
            flinders: None,
        };
        let measured = binnacle.calibrated_pair(&set.size, set.mark_mm);
        let sd = measured.map_or(size.tolerance, |measured| measured.sd);
        let effect = Iron::new(binnacle, &soft).effect(binnacle.design.needle_moment_am2);
        let of_needles = Effect {
            needle_nt: effect.needle_nt,
            ..Effect::default()
        };
        let name = set.size.clone();
        let error = PieceError {
            piece: name,
            error: effect.times(sd),
        };
        Some((error, of_needles.times(NEEDLE_SD)))
    };
    let (old, old_needles) = one(from).unzip();
    let (new, new_needles) = one(to).unzip();
    // The needles stay the same with any soft iron.
    let [new_needles, old_needles] = [new_needles, old_needles].map(Option::unwrap_or_default);
    let mut errors = differing(old, new);
    errors.push(new_needles.less(&old_needles));
    errors
}

fn bar(binnacle: &Binnacle, from: &Setting, to: &Setting) -> Vec<Effect> {
    if from.flinders == to.flinders {
        return Vec::new();
    }
    let one = |setting: &Setting| {
        let set = setting.flinders.as_ref()?;
        let holder = binnacle.design.flinders.as_ref()?;
        let soft = Soft {
            quadrantal: None,
            flinders: Some(set.clone()),
        };
        let measured = binnacle.calibrated_bar(set.length_mm);
        let sd = measured.map_or(holder.tolerance, |measured| measured.sd);
        Some(PieceError {
            piece: (),
            error: Iron::new(binnacle, &soft).effect(0.0).times(sd),
        })
    };
    differing(one(from), one(to))
}

/// Error of the effect of a piece of soft iron.
struct PieceError<T> {
    /// Name of the piece.
    piece: T,
    error: Effect,
}

/// Combines the errors: the difference for the same piece of iron, both for different
/// pieces.
fn differing<T: PartialEq>(old: Option<PieceError<T>>, new: Option<PieceError<T>>) -> Vec<Effect> {
    match (old, new) {
        (Some(old), Some(new)) if old.piece == new.piece => {
            vec![new.error.less(&old.error)]
        }
        (old, new) => [old, new]
            .into_iter()
            .flatten()
            .map(|one| one.error)
            .collect(),
    }
}
