//! Effects of the correctors of a setting.

use super::effect::{Effect, Vector};
use super::iron::Iron;
use super::magnet::BarMagnet;
use crate::binnacle::{Axis, BinnacleForm, HeelingSetting, Setting, Tray};

/// Computes the field at the card, nT, of one magnet in a hole with its red end forward or
/// to starboard, including the induction in the soft iron; `None` without such a hole or
/// kind.
pub fn magnet_field(
    binnacle: &BinnacleForm,
    iron: &Iron,
    axis: Axis,
    kind: &str,
    hole: u16,
) -> Option<Vector> {
    let moment = binnacle.moment(binnacle.design.magnet(kind)?);
    let rack = binnacle.design.rack(axis);
    let depth_m = rack.hole(hole)?.below_card_mm / 1e3;
    let off_m = rack.off_centre_mm / 1e3;
    let (centre, along) = match axis {
        Axis::ForeAndAft => ([0.0, off_m, depth_m], [1.0, 0.0, 0.0]),
        Axis::Athwartship => ([off_m, 0.0, depth_m], [0.0, 1.0, 0.0]),
    };
    let magnet = |sign: f64| BarMagnet {
        centre: [sign * centre[0], sign * centre[1], centre[2]],
        moment: along.map(|part: f64| part * moment.am2),
        length_m: moment.length_mm / 1e3,
    };
    let measured = binnacle.calibrated_magnet(axis, kind, hole);
    // Magnets are on both sides of the middle in turn: one counts as the mean.
    Some(half_sum([1.0, -1.0].map(|side| {
        seen(&magnet(side), iron, measured.map(|m| m.value))
    })))
}

/// Computes the field at the card, nT, of one heeling magnet with its red end down.
pub fn heeling_field(binnacle: &BinnacleForm, iron: &Iron, position: u16) -> Option<Vector> {
    let bucket = binnacle.design.heeling.as_ref()?;
    let moment = binnacle.moment(binnacle.design.magnet(&bucket.magnet)?);
    let place = bucket.positions.iter().find(|p| p.number == position)?;
    let magnet = BarMagnet {
        centre: [0.0, 0.0, place.below_card_mm / 1e3],
        moment: [0.0, 0.0, moment.am2],
        length_m: moment.length_mm / 1e3,
    };
    Some(seen(&magnet, iron, binnacle.calibrated_heeling(position)))
}

/// Adds the iron's field to a magnet's field, scaled to the measured value.
fn seen(magnet: &BarMagnet, iron: &Iron, measured_nt: Option<f64>) -> Vector {
    let direct = magnet.field_nt([0.0; 3]);
    let size = direct.iter().map(|part| part * part).sum::<f64>().sqrt();
    let scale = measured_nt.map_or(1.0, |measured| measured / size);
    let reflected = iron.reflected(magnet);
    std::array::from_fn(|axis| scale * (direct[axis] + reflected[axis]))
}

fn half_sum([one, other]: [Vector; 2]) -> Vector {
    std::array::from_fn(|axis| f64::midpoint(one[axis], other[axis]))
}

/// Computes the effect of all correctors of a setting.
pub fn effect(binnacle: &BinnacleForm, setting: &Setting) -> Effect {
    let iron = Iron::new(binnacle, &setting.soft());
    let mut effect = iron.effect(binnacle.design.needle_moment_am2);
    for axis in Axis::BOTH {
        for tray in setting.trays(axis) {
            effect.add(&tray_effect(binnacle, &iron, axis, tray), 1.0);
        }
    }
    if let Some(heeling) = &setting.heeling {
        effect.add(&heeling_effect(binnacle, &iron, heeling), 1.0);
    }
    effect
}

/// Computes the effect of the magnets of one hole or tray.
pub fn tray_effect(binnacle: &BinnacleForm, iron: &Iron, axis: Axis, tray: &Tray) -> Effect {
    let one = magnet_field(binnacle, iron, axis, &tray.magnet, tray.hole);
    permanent(one, tray.red.sign() * f64::from(tray.count))
}

/// Computes the effect of the vertical magnets.
pub fn heeling_effect(binnacle: &BinnacleForm, iron: &Iron, set: &HeelingSetting) -> Effect {
    let one = heeling_field(binnacle, iron, set.position);
    permanent(one, set.red.sign() * f64::from(set.count))
}

fn permanent(one: Option<Vector>, factor: f64) -> Effect {
    Effect {
        b_nt: one.unwrap_or_default().map(|part| factor * part),
        ..Effect::default()
    }
}
