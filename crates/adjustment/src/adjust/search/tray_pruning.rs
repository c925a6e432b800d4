//! Ways to fill a rack with more trays than all of them could be gone through: of those
//! that do nearly the same, one.
//!
//! The fields of trays add up. So the sets of one tray more are those of one tray fewer
//! with any holding beside, and of all whose fields fall into one cell, and that keep as
//! many trays where they stand, the one with the fewest movements of hand stays. What is
//! left out thereby is not lost: the search bounds what it could do (`Search::relaxed`).

use super::magnet_use::MagnetUse;
use std::ops::RangeInclusive;

/// Cells between no field and the strongest: a few nT each.
const CELLS: usize = 6_000;

/// What one hole may hold.
pub(crate) struct PruningCandidate {
    pub(crate) hole: u16,
    /// Its field where no iron stands, nT.
    pub(crate) field_nt: f64,
    pub(crate) used: MagnetUse,
    /// Whether it stands there already.
    pub(crate) stands: bool,
    /// Movements of hand and magnets that it takes by itself, for choosing among equals.
    pub(crate) cost: u32,
}

/// Some items in holes that differ.
#[derive(Clone)]
struct TraySet {
    items: Vec<usize>,
    field_nt: f64,
    used: MagnetUse,
    stand: usize,
    cost: u32,
}

/// Sets of as many items as are asked for, by their indices.
pub(crate) fn prune(
    items: &[PruningCandidate],
    many: &RangeInclusive<u8>,
    stock: MagnetUse,
) -> Vec<Vec<usize>> {
    let strongest_nt = items.iter().map(|item| item.field_nt).fold(0.0, f64::max);
    let most = usize::from(*many.end());
    let full_nt = strongest_nt * most as f64;
    if full_nt <= 0.0 {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut sets = vec![TraySet {
        items: Vec::new(),
        field_nt: 0.0,
        used: MagnetUse::default(),
        stand: 0,
        cost: 0,
    }];
    for size in 1..=*many.end() {
        sets = extend_sets(&sets, items, full_nt, most, stock);
        if many.contains(&size) {
            found.extend(sets.iter().map(|set| set.items.clone()));
        }
    }
    found
}

fn extend_sets(
    sets: &[TraySet],
    items: &[PruningCandidate],
    full_nt: f64,
    most: usize,
    stock: MagnetUse,
) -> Vec<TraySet> {
    let mut cells: Vec<Option<TraySet>> = vec![None; (most + 1) * (CELLS + 1)];
    for set in sets {
        for (index, item) in items.iter().enumerate() {
            let used = set.used.plus(item.used);
            let is_taken = set.items.iter().any(|held| items[*held].hole == item.hole);
            if is_taken || !used.within(stock) {
                continue;
            }
            let field_nt = set.field_nt + item.field_nt;
            let stand = set.stand + usize::from(item.stands);
            let cost = set.cost + item.cost;
            let cell = (CELLS as f64 * field_nt / full_nt) as usize;
            let place = &mut cells[stand * (CELLS + 1) + cell.min(CELLS)];
            if place.as_ref().is_none_or(|known| cost < known.cost) {
                let mut held = set.items.clone();
                held.push(index);
                *place = Some(TraySet {
                    items: held,
                    field_nt,
                    used,
                    stand,
                    cost,
                });
            }
        }
    }
    cells.into_iter().flatten().collect()
}
