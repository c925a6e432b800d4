//! Search over all settings: soft iron first, and for each the magnets of both axes by
//! branch and bound.
//!
//! Invariants: the best setting is kept for every number of moves. A family of settings is
//! skipped only when a bound excludes any improvement beyond `SLACK_DEG` for its moves. The
//! result is therefore the best of the whole catalogue for every number of moves, unless
//! `MOST_NODES` ended the search, or a rack has too many settings. In these cases a gap
//! bounds the possible improvement: it treats the racks' reach as a continuum.

pub(crate) mod candidates;
mod magnet_use;
pub(crate) mod objective;
pub(crate) mod soft_iron;
mod tray_pruning;

mod front;
mod relaxation;
mod tree;

pub use front::Optimality;
pub(crate) use front::{BestSetting, ParetoFront};

use super::corrector_moves;
use super::heeling;
use super::inputs::Adjustment;
use super::state::{IronBands, MagneticState};
use crate::binnacle::{Axis, HeelingSetting, Setting, Soft};
use crate::corrector::{Effect, Iron, heeling_effect};
use candidates::{AxisCandidates, AxisSetting};
use front::SLACK_DEG;
use magnet_use::{MagnetUse, stock, used_by};
use objective::{FieldBox, HeadingGrid, Objective};
use relaxation::relaxed_within;
use soft_iron::iron;
use tree::{Group, Pair};

/// Greatest number of nodes: about ten seconds of one core.
const MOST_NODES: u64 = 6_000_000;
/// Gap of a search with a proven optimum, degrees: finer than any reading of a card.
const PROVEN_DEG: f64 = 0.05;
/// A choice of soft iron with its heeling magnets.
struct IronChoice {
    soft: Soft,
    heeling: Option<HeelingSetting>,
    moves: u32,
    used: MagnetUse,
    iron: Iron,
    effect: Effect,
    bound_deg: f64,
}

/// Common data of all choices.
struct Search<'s> {
    adjustment: &'s Adjustment<'s>,
    state: &'s MagneticState<'s>,
    compass: HeadingGrid,
    axes: [AxisCandidates; 2],
    groups: [Vec<Group>; 2],
    stock: MagnetUse,
}

pub(crate) fn search(adjustment: &Adjustment<'_>, state: &MagneticState<'_>) -> ParetoFront {
    let binnacle = state.binnacle;
    let standing = adjustment.standing();
    let axes = Axis::BOTH.map(|axis| AxisCandidates::new(binnacle, axis, standing));
    let search = Search {
        adjustment,
        state,
        compass: HeadingGrid::new(state.constant_deg()),
        groups: [0, 1].map(|axis| Group::by_moves(state, &axes[axis])),
        axes,
        stock: stock(binnacle),
    };
    let mut front = ParetoFront::new();
    front.optimality.trays_in_use = [search.axes[0].trays, search.axes[1].trays];
    let irons = iron(state, standing);
    let mut choices: Vec<IronChoice> = irons
        .into_iter()
        // Settings with few moves tighten the bounds of those with more.
        .map(|(soft, moves)| search.with_present_magnets(soft, moves, &mut front))
        .collect();
    choices.sort_by(|a, b| {
        let by_bound = a.bound_deg.total_cmp(&b.bound_deg);
        by_bound.then(a.moves.cmp(&b.moves))
    });
    for choice in &choices {
        search.magnets(choice, &mut front);
    }
    if !search.axes.iter().all(|axis| axis.is_complete) {
        search.bound_unsearched(&choices, &mut front);
    }
    let best_deg = front.at(u32::MAX);
    let optimality = &mut front.optimality;
    optimality.gap_deg = (best_deg - front.left_out_deg).max(SLACK_DEG);
    optimality.proven = optimality.gap_deg <= PROVEN_DEG;
    front
}

impl Search<'_> {
    fn objective(&self, soft: &Soft, effect: &Effect) -> Objective<'_> {
        let waters = self.adjustment.waters;
        let bands = IronBands::new(self.state, self.adjustment.standing(), soft, waters);
        Objective::new(
            &self.compass,
            waters,
            |h_nt| self.state.with_effect(effect, h_nt),
            |water, magnetic_rad| bands.band_rad(water, magnetic_rad),
        )
    }

    /// Evaluates a choice with its bound, and offers it with the present magnets.
    fn with_present_magnets(&self, soft: Soft, moves: u32, front: &mut ParetoFront) -> IronChoice {
        let binnacle = self.state.binnacle;
        let iron = Iron::new(binnacle, &soft);
        let of_iron = iron.effect(binnacle.design.needle_moment_am2);
        let heeling = heeling::choose_magnets(self.adjustment, self.state, &iron, &of_iron);
        let of_heeling = heeling
            .as_ref()
            .map(|set| heeling_effect(binnacle, &iron, set));
        let effect = of_iron.plus(&of_heeling.unwrap_or_default());
        let objective = self.objective(&soft, &effect);
        let bucket = binnacle.design.heeling.as_ref().zip(heeling.as_ref());
        let used = bucket.map(|(bucket, set)| used_by(binnacle, &bucket.magnet, set.count));
        let stood = self.adjustment.standing().heeling.as_ref();
        let choice = IronChoice {
            moves: moves + corrector_moves::heeling_moves(stood, heeling.as_ref()),
            bound_deg: objective.bound_for_iron(),
            soft,
            heeling,
            used: used.unwrap_or_default(),
            iron,
            effect,
        };
        let [one, other] = &self.axes;
        let b = [one, other]
            .map(|axis| axis.settings[0].field_nt(&axis.fields(binnacle, &choice.iron)));
        let reach_deg = objective.reach_deg([b[0][0] + b[1][0], b[0][1] + b[1][1]]);
        front.offer(choice.moves, reach_deg, || {
            setting(&choice, &one.settings[0], &other.settings[0])
        });
        choice
    }
}

fn setting(choice: &IronChoice, fore_and_aft: &AxisSetting, athwartship: &AxisSetting) -> Setting {
    Setting {
        fore_and_aft: fore_and_aft.trays.clone(),
        athwartship: athwartship.trays.clone(),
        quadrantal: choice.soft.quadrantal.clone(),
        flinders: choice.soft.flinders.clone(),
        heeling: choice.heeling.clone(),
    }
}

impl Search<'_> {
    /// Searches the magnets of one choice of iron.
    fn magnets(&self, choice: &IronChoice, front: &mut ParetoFront) {
        let mut known = None;
        let mut trees = [0, 1].map(|a| vec![None; self.groups[a].len()]);
        for (i, one) in self.groups[0].iter().enumerate() {
            for (j, other) in self.groups[1].iter().enumerate() {
                let moves = choice.moves + one.moves + other.moves;
                if choice.bound_deg >= front.at(moves) - SLACK_DEG {
                    continue;
                }
                let (fields, objective) = known.get_or_insert_with(|| {
                    let fields = |a: usize| self.axes[a].fields(self.state.binnacle, &choice.iron);
                    let objective = self.objective(&choice.soft, &choice.effect);
                    ([fields(0), fields(1)], objective)
                });
                let [along, across] = &mut trees;
                let along =
                    along[i].get_or_insert_with(|| one.tree(&self.axes[0].settings, &fields[0]));
                let across =
                    across[j].get_or_insert_with(|| other.tree(&self.axes[1].settings, &fields[1]));
                let pair = Pair {
                    groups: [one, other],
                    trees: [along, across],
                    moves,
                };
                self.descend(choice, objective, &pair, front);
            }
        }
    }

    /// Bounds the improvement by untried settings.
    fn bound_unsearched(&self, choices: &[IronChoice], front: &mut ParetoFront) {
        let mut left_deg = front.left_out_deg.min(front.at(u32::MAX) - SLACK_DEG);
        let mut nodes = 0;
        for choice in choices {
            if choice.bound_deg >= left_deg {
                continue;
            }
            let reach = |axis: usize| {
                let fields = self.axes[axis].fields(self.state.binnacle, &choice.iron);
                self.axes[axis].reach_nt(&fields)
            };
            let (one, other) = (reach(0), reach(1));
            let [x, y] = [0, 1].map(|part| one[part] + other[part]);
            let within = FieldBox {
                x: [-x, x],
                y: [-y, y],
            };
            let objective = self.objective(&choice.soft, &choice.effect);
            left_deg = relaxed_within(&objective, within, left_deg, &mut nodes);
        }
        front.optimality.nodes += nodes;
        front.left_out_deg = left_deg;
    }

    /// Descends both trees together, the better half first.
    fn descend(
        &self,
        choice: &IronChoice,
        objective: &Objective<'_>,
        pair: &Pair<'_>,
        front: &mut ParetoFront,
    ) {
        let bound = |node: [usize; 2]| objective.bound_deg(&pair.within(node));
        let mut open = vec![([1, 1], bound([1, 1]))];
        while let Some((node, node_bound)) = open.pop() {
            if node_bound >= front.at(pair.moves) - SLACK_DEG {
                continue;
            }
            if front.optimality.nodes >= MOST_NODES {
                let bound_deg = node_bound.max(choice.bound_deg);
                front.left_out_deg = front.left_out_deg.min(bound_deg);
                continue;
            }
            front.optimality.nodes += 1;
            if let [Some(one), Some(other)] = [0, 1].map(|a| pair.leaf(a, node[a])) {
                let [one, other] = [&self.axes[0].settings[one], &self.axes[1].settings[other]];
                if one
                    .used
                    .plus(other.used)
                    .plus(choice.used)
                    .within(self.stock)
                {
                    let within = pair.within(node);
                    let reach_deg = objective.reach_deg([within.x[0], within.y[0]]);
                    front.offer(pair.moves, reach_deg, || setting(choice, one, other));
                }
                continue;
            }
            let split = pair.wider(node);
            let mut children = [0, 1].map(|which| {
                let mut child = node;
                child[split] = 2 * node[split] + which;
                (child, bound(child))
            });
            // The stack's last entry comes first.
            if children[0].1 < children[1].1 {
                children.swap(0, 1);
            }
            open.extend(children);
        }
    }
}
