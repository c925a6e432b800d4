//! Numbers of magnets in use, by kind.

use crate::binnacle::Binnacle;

/// Number of kinds of magnets, a byte each.
const KINDS: usize = 8;

/// Number of magnets in use of each kind, a byte each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct MagnetUse(u64);

impl MagnetUse {
    pub(crate) fn plus(self, other: MagnetUse) -> MagnetUse {
        MagnetUse(self.0 + other.0)
    }

    /// Returns true when no kind exceeds the stock.
    pub(crate) fn within(self, stock: MagnetUse) -> bool {
        (0..KINDS).all(|kind| self.count(kind) <= stock.count(kind))
    }

    fn count(self, kind: usize) -> u64 {
        (self.0 >> (8 * kind)) & 0xff
    }

    fn some(kind: usize, count: u64) -> MagnetUse {
        MagnetUse(count.min(255) << (8 * kind))
    }
}

/// Counts the magnets on board.
pub(crate) fn stock(binnacle: &Binnacle) -> MagnetUse {
    let kinds = binnacle.design.magnets.iter().take(KINDS).enumerate();
    kinds.fold(MagnetUse::default(), |sum, (index, kind)| {
        // Half of a byte's range is reserved for the sum of two axes.
        let count = binnacle.magnet_count(&kind.name).min(100);
        sum.plus(MagnetUse::some(index, u64::from(count)))
    })
}

pub(crate) fn used_by(binnacle: &Binnacle, magnet: &str, count: u8) -> MagnetUse {
    let index = binnacle
        .design
        .magnets
        .iter()
        .position(|kind| kind.name == magnet);
    index.map_or_else(MagnetUse::default, |index| {
        MagnetUse::some(index, u64::from(count))
    })
}
