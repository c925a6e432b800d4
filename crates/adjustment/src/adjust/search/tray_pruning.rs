//! Pruning of tray combinations in a rack with too many: one of those with nearly the same
//! field.
//!
//! The fields of trays add up. Sets with one more tray are those with one fewer and any
//! other candidate. Of all sets with a field in the same cell and the same number of
//! unmoved trays, the one with the fewest moves is kept. The pruned sets are not lost: the
//! search bounds their possible improvement (`Search::bound_unsearched`).

use super::magnet_use::MagnetUse;
use std::ops::RangeInclusive;

/// Number of cells up to the strongest field: a few nT each.
const CELLS: usize = 6_000;

/// Magnets in one hole.
pub(crate) struct PruningCandidate {
    pub(crate) hole: u16,
    /// Field without soft iron, nT.
    pub(crate) field_nt: f64,
    pub(crate) used: MagnetUse,
    /// Already in place.
    pub(crate) stands: bool,
    /// Moves and magnets of this hole alone, for choosing among equals.
    pub(crate) cost: u32,
}

/// Candidates in different holes.
#[derive(Clone)]
struct TraySet {
    items: Vec<usize>,
    field_nt: f64,
    used: MagnetUse,
    stand: usize,
    cost: u32,
}

/// Returns pruned sets of each requested size, by their indices.
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
