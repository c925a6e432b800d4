//! What correctors do at the card, as contributions to Poisson's equations.
//!
//! Ideal shapes by docs/science.md, §10, or what was measured of this binnacle
//! (`calibration`), which wins. What always holds: effects are in ship axes and
//! nT at the card's centre, the earth's field is that of no ship, and magnets add up
//! linearly once the soft iron stands: their poles magnetise spheres and bar.

mod flinders;
mod magnet;
mod sphere;

pub use flinders::{Bar, demagnetising};
pub use magnet::{BarMagnet, MAGNETIC};
pub use sphere::{KAPPA, Pair};

use crate::binnacle::{Axis, BinnacleForm, HeelingSetting, Setting, Side, Soft, Tray};
use binnacle_compass::ship::ShipMagnetism;

/// A vector in ship axes: forward, starboard, down.
pub type Vector = [f64; 3];

/// A contribution to Poisson's equations, `B = h + (χ + Δχ + N/H) h + b + Δb`
/// (docs/science.md, eq. 18).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effect {
    /// Δχ.
    pub chi: [[f64; 3]; 3],
    /// Δb, nT.
    pub b_nt: Vector,
    /// N, nT: what the needles magnetise in the spheres turns with the card, so that
    /// it acts as soft iron that is stronger the weaker H is; on D and E alone, its
    /// trace being nil: it turns the card, and adds nothing to the directive force.
    pub needle_nt: [[f64; 2]; 2],
}

impl Effect {
    /// Both together.
    pub fn plus(mut self, other: &Effect) -> Effect {
        self.add(other, 1.0);
        self
    }

    /// This without the other.
    pub fn less(mut self, other: &Effect) -> Effect {
        self.add(other, -1.0);
        self
    }

    /// This effect so many times.
    pub fn times(&self, factor: f64) -> Effect {
        let mut scaled = Effect::default();
        scaled.add(self, factor);
        scaled
    }

    fn add(&mut self, other: &Effect, factor: f64) {
        for row in 0..3 {
            self.b_nt[row] += factor * other.b_nt[row];
            for column in 0..3 {
                self.chi[row][column] += factor * other.chi[row][column];
            }
        }
        for row in 0..2 {
            for column in 0..2 {
                self.needle_nt[row][column] += factor * other.needle_nt[row][column];
            }
        }
    }

    /// Soft iron, the needles' share included, where the horizontal field is H.
    pub fn chi_at(&self, h_nt: f64) -> [[f64; 3]; 3] {
        let mut chi = self.chi;
        for (chi, needle) in chi.iter_mut().zip(self.needle_nt) {
            for (chi, needle) in chi.iter_mut().zip(needle) {
                *chi += needle / h_nt;
            }
        }
        chi
    }

    /// The same as a ship of its own, where the horizontal field is H.
    pub fn as_ship(&self, h_nt: f64) -> ShipMagnetism {
        ShipMagnetism {
            chi: self.chi_at(h_nt),
            b_nt: self.b_nt,
        }
    }
}

/// The soft iron of a setting as it stands, ready to be magnetised.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Iron {
    /// Spheres.
    pub pair: Option<Pair>,
    /// Flinders bar.
    pub bar: Option<Bar>,
}

impl Iron {
    /// The iron of a setting of this binnacle; what the binnacle does not have, and
    /// what a checked setting thus cannot name, is left out.
    pub fn new(binnacle: &BinnacleForm, soft: &Soft) -> Iron {
        Iron {
            pair: soft.quadrantal.as_ref().and_then(|set| {
                let iron = binnacle.design.quadrantal.as_ref()?;
                let size = iron.sizes.iter().find(|size| size.name == set.size)?;
                let mark =
                    |m: &&crate::binnacle::Mark| crate::binnacle::same(m.mark_mm, set.mark_mm);
                let mark = iron.marks.iter().find(mark)?;
                let pair = Pair::new(size.diameter_mm / 2e3, mark.centre_mm / 1e3, set.slew_deg);
                let measured = binnacle.calibrated_pair(&set.size, set.mark_mm);
                Some(measured.map_or(pair, |found| pair.measured(found.value)))
            }),
            bar: soft.flinders.as_ref().and_then(|set| {
                let holder = binnacle.design.flinders.as_ref()?;
                let side_deg = match set.side {
                    Side::Forward => 0.0,
                    Side::Aft => 180.0,
                };
                let bar = Bar::new(
                    set.length_mm / 1e3,
                    holder.diameter_mm / 1e3,
                    holder.axis_mm / 1e3,
                    side_deg + set.slew_deg,
                );
                let measured = binnacle.calibrated_bar(set.length_mm);
                Some(measured.map_or(bar, |found| bar.measured(found.value)))
            }),
        }
    }

    /// What it does in the earth's field, with needles of this moment, A·m².
    pub fn effect(&self, needle_am2: f64) -> Effect {
        let mut effect = Effect::default();
        if let Some(pair) = &self.pair {
            effect.add(&pair.effect(needle_am2), 1.0);
        }
        if let Some(bar) = &self.bar {
            effect.add(&bar.effect(), 1.0);
        }
        effect
    }

    /// What it adds to a magnet's field at the card, nT: the magnet magnetises it.
    pub fn reflected(&self, magnet: &BarMagnet) -> Vector {
        let mut sum = [0.0; 3];
        let parts = [
            self.pair.map(|pair| pair.reflected(magnet)),
            self.bar.map(|bar| bar.reflected(magnet)),
        ];
        for part in parts.into_iter().flatten() {
            for (sum, part) in sum.iter_mut().zip(part) {
                *sum += part;
            }
        }
        sum
    }
}

/// The field at the card, nT, of one magnet in a hole with its red end forward or to
/// starboard, soft iron standing as given; `None` where there is no such hole or kind.
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
    // Magnets stand on both sides of the middle in turn: one counts as the mean.
    Some(half_sum([1.0, -1.0].map(|side| {
        seen(&magnet(side), iron, measured.map(|m| m.value))
    })))
}

/// The field at the card, nT, of one heeling magnet with its red end down.
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

/// A magnet's field with what the iron adds; its own part scaled to what was measured.
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

/// Everything that a setting does.
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

/// What the magnets of one hole or tray do.
pub fn tray_effect(binnacle: &BinnacleForm, iron: &Iron, axis: Axis, tray: &Tray) -> Effect {
    let one = magnet_field(binnacle, iron, axis, &tray.magnet, tray.hole);
    permanent(one, tray.red.sign() * f64::from(tray.count))
}

/// What the vertical magnets do.
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

#[cfg(test)]
mod tests;
