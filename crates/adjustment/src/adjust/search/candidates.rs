//! Possible magnet settings of an axis.

use super::magnet_use::{MagnetUse, stock, used_by};
use super::tray_pruning::{self, PruningCandidate};
use crate::adjust::corrector_moves;
use crate::binnacle::{Axis, Binnacle, Setting, Tray};
use crate::corrector::{Iron, Vector, magnet_field};
use std::ops::RangeInclusive;

/// Greatest number of settings of one axis; beyond it, settings with more trays are pruned
/// to one per few nT.
const MOST_SETTINGS: usize = 40_000;
/// Magnets in one hole, red end forward or to starboard.
struct TrayCandidate {
    tray: Tray,
    used: MagnetUse,
    /// Index of hole and kind among the fields of single magnets.
    field: usize,
}

/// Capacity of a rack, by the fields of single magnets.
struct Capacity {
    at_once: usize,
    magnets_each: f64,
    /// Number on board of each kind that fits.
    in_stock: Vec<f64>,
}

/// A setting of the magnets of an axis.
#[derive(Clone, Debug)]
pub(crate) struct AxisSetting {
    pub(crate) trays: Vec<Tray>,
    pub(crate) used: MagnetUse,
    pub(crate) moves: u32,
    /// Fields of single magnets with their multiplicity.
    parts: Vec<(usize, f64)>,
}

impl AxisSetting {
    /// Returns the field at the card, nT: forward and starboard.
    pub(crate) fn field_nt(&self, single: &[Vector]) -> [f64; 2] {
        let parts = self.parts.iter();
        parts.fold([0.0; 2], |sum, (index, count)| {
            [0, 1].map(|axis| sum[axis] + count * single[*index][axis])
        })
    }
}

/// All settings of the magnets of an axis.
pub(crate) struct AxisCandidates {
    axis: Axis,
    /// Holes and kinds in the order of the fields of single magnets.
    singles: Vec<(u16, String)>,
    pub(crate) settings: Vec<AxisSetting>,
    /// Greatest number of trays or holes in use at once.
    pub(crate) trays: u8,
    /// Complete: every setting is included.
    pub(crate) is_complete: bool,
    capacity: Capacity,
}

impl AxisCandidates {
    /// Lists all settings within stock, the present one first; magnets with opposing red
    /// ends are excluded, because they only weaken each other.
    pub(crate) fn new(binnacle: &Binnacle, axis: Axis, standing: &Setting) -> AxisCandidates {
        let rack = binnacle.design.rack(axis);
        let stock = stock(binnacle);
        let mut singles = Vec::new();
        let mut candidates_in_holes = Vec::new();
        for hole in &rack.holes {
            for magnet in &rack.magnets {
                for count in 1..=rack.magnets_each {
                    let used = used_by(binnacle, magnet, count);
                    if !used.within(stock) {
                        continue;
                    }
                    candidates_in_holes.push(TrayCandidate {
                        tray: Tray {
                            hole: hole.number,
                            magnet: magnet.clone(),
                            count,
                            red: axis.red(true),
                        },
                        used,
                        field: singles.len(),
                    });
                }
                singles.push((hole.number, magnet.clone()));
            }
        }
        let standing = standing.trays(axis);
        let mut candidates = AxisCandidates {
            axis,
            singles,
            settings: Vec::new(),
            trays: 0,
            is_complete: true,
            capacity: Capacity {
                at_once: usize::from(rack.at_once),
                magnets_each: f64::from(rack.magnets_each),
                in_stock: rack
                    .magnets
                    .iter()
                    .map(|magnet| f64::from(binnacle.magnet_count(magnet)))
                    .collect(),
            },
        };
        let as_it_stands = candidates.axis_setting(binnacle, standing);
        candidates.settings.push(as_it_stands);
        candidates.add(&[], &candidates_in_holes, standing, stock);
        for trays in 1..=rack.at_once {
            let chosen = combinations(&candidates_in_holes, usize::from(trays));
            if candidates.settings.len() + 2 * chosen.len() > MOST_SETTINGS {
                candidates.add_pruned(
                    &(trays..=rack.at_once),
                    binnacle,
                    &candidates_in_holes,
                    standing,
                );
                break;
            }
            candidates.trays = trays;
            for chosen in chosen {
                candidates.add(&chosen, &candidates_in_holes, standing, stock);
            }
        }
        candidates
    }

    /// Adds the settings with these numbers of trays, pruned to one per few nT.
    fn add_pruned(
        &mut self,
        trays: &RangeInclusive<u8>,
        binnacle: &Binnacle,
        candidates_in_holes: &[TrayCandidate],
        standing: &[Tray],
    ) {
        (self.is_complete, self.trays) = (false, *trays.end());
        let stock = stock(binnacle);
        let fields = self.fields(binnacle, &Iron::default());
        let along = usize::from(self.axis == Axis::Athwartship);
        for positive in [true, false] {
            let red = self.axis.red(positive);
            let item = |h: &TrayCandidate| {
                let tray = Tray {
                    red,
                    ..h.tray.clone()
                };
                let alone = standing.iter().map(|stood| {
                    corrector_moves::tray_moves(
                        std::slice::from_ref(stood),
                        std::slice::from_ref(&tray),
                    )
                });
                PruningCandidate {
                    hole: tray.hole,
                    field_nt: (f64::from(tray.count) * fields[h.field][along]).abs(),
                    used: h.used,
                    stands: standing.contains(&tray),
                    cost: 8 * alone.min().unwrap_or(1).min(2) + u32::from(tray.count),
                }
            };
            let items: Vec<PruningCandidate> = candidates_in_holes.iter().map(item).collect();
            for chosen in tray_pruning::prune(&items, trays, stock) {
                self.add_with(positive, &chosen, candidates_in_holes, standing);
            }
        }
    }

    /// Bounds the field of any setting of the rack, nT: forward and to starboard, in either
    /// direction.
    pub(crate) fn reach_nt(&self, single: &[Vector]) -> [f64; 2] {
        let Capacity {
            at_once,
            magnets_each,
            in_stock,
        } = &self.capacity;
        let kinds = in_stock.len().max(1);
        [0, 1].map(|part| {
            let of = |index: usize| single[index][part].abs();
            // Each hole holds its strongest kind, regardless of stock.
            let holes = (0..single.len()).step_by(kinds);
            let mut strongest: Vec<f64> = holes
                .map(|first| (first..first + kinds).map(of).fold(0.0, f64::max))
                .collect();
            strongest.sort_by(|a, b| b.total_cmp(a));
            let with_holes = magnets_each * strongest.iter().take(*at_once).sum::<f64>();
            // Each kind has the whole rack, up to its stock.
            let with_stock = (0..kinds).map(|kind| {
                let mut of_kind: Vec<f64> = (kind..single.len()).step_by(kinds).map(of).collect();
                of_kind.sort_by(|a, b| b.total_cmp(a));
                let mut left = in_stock.get(kind).copied().unwrap_or(0.0);
                let mut sum = 0.0;
                for one in of_kind.into_iter().take(*at_once) {
                    let count = magnets_each.min(left);
                    sum += count * one;
                    left -= count;
                }
                sum
            });
            with_holes.min(with_stock.sum())
        })
    }

    fn add(
        &mut self,
        chosen: &[usize],
        candidates_in_holes: &[TrayCandidate],
        standing: &[Tray],
        stock: MagnetUse,
    ) {
        let held = chosen.iter().map(|index| &candidates_in_holes[*index]);
        let used = held.fold(MagnetUse::default(), |sum, h| sum.plus(h.used));
        if !used.within(stock) {
            return;
        }
        for positive in [true, false] {
            self.add_with(positive, chosen, candidates_in_holes, standing);
        }
    }

    fn add_with(
        &mut self,
        positive: bool,
        chosen: &[usize],
        candidates_in_holes: &[TrayCandidate],
        standing: &[Tray],
    ) {
        let held = || chosen.iter().map(|index| &candidates_in_holes[*index]);
        let red = self.axis.red(positive);
        let with_red = |h: &TrayCandidate| Tray {
            red,
            ..h.tray.clone()
        };
        let trays: Vec<Tray> = held().map(with_red).collect();
        let moves = corrector_moves::tray_moves(standing, &trays);
        // The present setting is already included, and no magnets have no other end.
        if moves > 0 && (positive || !trays.is_empty()) {
            let parts = held().map(|h| (h.field, red.sign() * f64::from(h.tray.count)));
            self.settings.push(AxisSetting {
                parts: parts.collect(),
                trays,
                used: held().fold(MagnetUse::default(), |sum, h| sum.plus(h.used)),
                moves,
            });
        }
    }

    fn axis_setting(&self, binnacle: &Binnacle, trays: &[Tray]) -> AxisSetting {
        let single = |tray: &Tray| {
            let found = self
                .singles
                .iter()
                .position(|(h, m)| *h == tray.hole && *m == tray.magnet);
            found.map(|index| (index, tray.red.sign() * f64::from(tray.count)))
        };
        let used = trays.iter().map(|t| used_by(binnacle, &t.magnet, t.count));
        AxisSetting {
            trays: trays.to_vec(),
            used: used.fold(MagnetUse::default(), MagnetUse::plus),
            moves: 0,
            parts: trays.iter().filter_map(single).collect(),
        }
    }

    /// Returns the fields of single magnets with this soft iron.
    pub(crate) fn fields(&self, binnacle: &Binnacle, iron: &Iron) -> Vec<Vector> {
        let of = |(hole, magnet): &(u16, String)| {
            magnet_field(binnacle, iron, self.axis, magnet, *hole).unwrap_or_default()
        };
        self.singles.iter().map(of).collect()
    }
}

/// Lists all combinations of candidates in different holes.
fn combinations(candidates_in_holes: &[TrayCandidate], many: usize) -> Vec<Vec<usize>> {
    let mut all = Vec::new();
    let mut chosen = Vec::new();
    extend(candidates_in_holes, many, 0, &mut chosen, &mut all);
    all
}

fn extend(
    candidates_in_holes: &[TrayCandidate],
    many: usize,
    from: usize,
    chosen: &mut Vec<usize>,
    all: &mut Vec<Vec<usize>>,
) {
    if chosen.len() == many {
        all.push(chosen.clone());
        return;
    }
    for index in from..candidates_in_holes.len() {
        let last = chosen
            .last()
            .map(|last| candidates_in_holes[*last].tray.hole);
        // The limit keeps four trays of twelve magnets from filling the memory.
        if last == Some(candidates_in_holes[index].tray.hole) || all.len() > MOST_SETTINGS {
            continue;
        }
        chosen.push(index);
        extend(candidates_in_holes, many, index + 1, chosen, all);
        chosen.pop();
    }
}
