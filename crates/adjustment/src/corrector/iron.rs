//! Soft iron of a setting: spheres and Flinders bar.

use super::effect::{Effect, Vector};
use super::flinders::Bar;
use super::magnet::BarMagnet;
use super::sphere::Pair;
use crate::binnacle::{BinnacleForm, Mark, Side, Soft, nearly_equal};

/// Soft iron of a setting.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Iron {
    /// Spheres.
    pub pair: Option<Pair>,
    /// Flinders bar.
    pub bar: Option<Bar>,
}

impl Iron {
    /// Makes the iron of a setting of this binnacle; a corrector that the binnacle does not
    /// have is ignored.
    pub fn new(binnacle: &BinnacleForm, soft: &Soft) -> Iron {
        Iron {
            pair: soft.quadrantal.as_ref().and_then(|set| {
                let iron = binnacle.design.quadrantal.as_ref()?;
                let size = iron.sizes.iter().find(|size| size.name == set.size)?;
                let mark = |m: &&Mark| nearly_equal(m.mark_mm, set.mark_mm);
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

    /// Returns the effect in the earth's field, with needles of this moment, A·m².
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

    /// Returns the field added to a magnet's field at the card by its induction in the
    /// iron, nT.
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
