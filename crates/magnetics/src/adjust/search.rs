//! The search over all settings: soft iron first, and for each the magnets of both
//! axes by branch and bound.
//!
//! What always holds: of every number of moves the best setting found is kept, and a
//! family of settings is left out only where a bound says that none of it beats what is
//! known for its moves by more than `SLACK_DEG`. So the result is the best of the whole
//! catalogue for every number of moves, unless `MOST_NODES` ended the search; then the
//! gap says how much better something could be that was not looked at.

use super::candidates::{AxisCandidates, Magnets, Used, iron, stock, used_by};
use super::condition::Condition;
use super::objective::{Box2, Compass, Objective};
use super::{Adjustment, Optimality, heeling, moves};
use crate::binnacle::{Axis, HeelingSetting, Setting, Soft};
use crate::corrector::{Effect, Iron, heeling_effect};

/// Better by less is not looked for, degrees.
const SLACK_DEG: f64 = 0.005;
/// About ten seconds of one core.
const MOST_NODES: u64 = 6_000_000;
/// No setting takes more moves.
const MOST_MOVES: usize = 32;

/// The best for a number of moves.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub(super) setting: Setting,
    pub(super) moves: u32,
    pub(super) worst_deg: f64,
}

/// For every number of moves the best found with no more of them.
pub(super) struct Front {
    best: Vec<Option<Found>>,
    pub(super) optimality: Optimality,
    /// The least bound of what was not looked at.
    left_out_deg: f64,
}

impl Front {
    fn new() -> Front {
        Front {
            best: vec![None; MOST_MOVES],
            optimality: Optimality {
                proven: true,
                gap_deg: SLACK_DEG,
                nodes: 0,
                trays_in_use: [0; 2],
            },
            left_out_deg: f64::INFINITY,
        }
    }

    /// What is to be beaten with so many moves.
    fn at(&self, moves: u32) -> f64 {
        let known = self.best[..=(moves as usize).min(MOST_MOVES - 1)]
            .iter()
            .flatten();
        known
            .map(|found| found.worst_deg)
            .fold(f64::INFINITY, f64::min)
    }

    fn offer(&mut self, moves: u32, worst_deg: f64, setting: impl FnOnce() -> Setting) {
        if worst_deg < self.at(moves) && (moves as usize) < MOST_MOVES {
            self.best[moves as usize] = Some(Found {
                setting: setting(),
                moves,
                worst_deg,
            });
        }
    }

    /// Each better than all with fewer moves, fewest moves first.
    pub(super) fn undominated(&self) -> Vec<&Found> {
        let mut found: Vec<&Found> = Vec::new();
        for next in self.best.iter().flatten() {
            if found
                .last()
                .is_none_or(|last| next.worst_deg < last.worst_deg)
            {
                found.push(next);
            }
        }
        found
    }
}

/// One choice of soft iron with the heeling magnets that go with it.
struct Choice<'a> {
    soft: Soft,
    heeling: Option<HeelingSetting>,
    moves: u32,
    used: Used,
    iron: Iron,
    objective: Objective<'a>,
    bound_deg: f64,
}

pub(super) fn search(adjustment: &Adjustment<'_>, condition: &Condition<'_>) -> Front {
    let binnacle = condition.binnacle;
    let standing = adjustment.standing();
    let compass = Compass::new(condition.constant_deg());
    let mut choices: Vec<Choice<'_>> = iron(
        binnacle,
        standing,
        condition.may_move_pair,
        condition.may_move_bar,
    )
    .into_iter()
    .map(|(soft, moves)| choice(adjustment, condition, &compass, soft, moves))
    .collect();
    choices.sort_by(|a, b| {
        a.bound_deg
            .total_cmp(&b.bound_deg)
            .then(a.moves.cmp(&b.moves))
    });
    let axes = Axis::BOTH.map(|axis| AxisCandidates::new(binnacle, axis, standing));
    let groups = [0, 1].map(|axis| Group::by_moves(condition, &axes[axis]));
    let mut front = Front::new();
    front.optimality.trays_in_use = [axes[0].trays, axes[1].trays];
    // What is known of few moves makes the bounds of more moves bite.
    as_they_stand(condition, &axes, &mut choices, &mut front);
    for choice in &choices {
        magnets(condition, &axes, &groups, choice, &mut front);
    }
    let best = front.at(u32::MAX);
    if front.optimality.nodes >= MOST_NODES {
        front.optimality.proven = false;
        front.optimality.gap_deg = (best - front.left_out_deg).max(SLACK_DEG);
    }
    front
}

fn choice<'a>(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    compass: &'a Compass,
    soft: Soft,
    soft_moves: u32,
) -> Choice<'a> {
    let binnacle = condition.binnacle;
    let standing = adjustment.standing();
    let iron = Iron::new(binnacle, &soft);
    let of_iron = iron.effect(binnacle.design.needle_moment_am2);
    let heeling = heeling::chosen(adjustment, condition, &iron, &of_iron);
    let of_heeling = heeling
        .as_ref()
        .map(|set| heeling_effect(binnacle, &iron, set));
    let effect: Effect = of_iron.plus(&of_heeling.unwrap_or_default());
    let objective = Objective::new(compass, adjustment.waters, |h_nt| {
        condition.aboard(&effect, h_nt)
    });
    let bucket = binnacle.design.heeling.as_ref().zip(heeling.as_ref());
    let used = bucket.map(|(bucket, set)| used_by(binnacle, &bucket.magnet, set.count));
    Choice {
        moves: soft_moves + moves::heeling(standing.heeling.as_ref(), heeling.as_ref()),
        bound_deg: objective.bound_for_iron(),
        soft,
        heeling,
        used: used.unwrap_or_default(),
        iron,
        objective,
    }
}

/// Magnets of one axis that take the same number of moves, as a tree whose node i has
/// the children 2i and 2i + 1, and whose leaves are the second half.
struct Group {
    moves: u32,
    /// Indices of settings, by their field where no iron stands.
    members: Vec<usize>,
}

impl Group {
    fn by_moves(condition: &Condition<'_>, axis: &AxisCandidates) -> Vec<Group> {
        let fields = axis.fields(condition.binnacle, &Iron::default());
        let strength = |index: &usize| axis.settings[*index].field_nt(&fields).iter().sum::<f64>();
        let mut groups: Vec<Group> = Vec::new();
        for (index, setting) in axis.settings.iter().enumerate() {
            match groups.iter_mut().find(|group| group.moves == setting.moves) {
                Some(group) => group.members.push(index),
                None => groups.push(Group {
                    moves: setting.moves,
                    members: vec![index],
                }),
            }
        }
        groups.sort_by_key(|group| group.moves);
        for group in &mut groups {
            group
                .members
                .sort_by(|a, b| strength(a).total_cmp(&strength(b)));
        }
        groups
    }

    fn tree(&self, settings: &[Magnets], fields: &[crate::corrector::Vector]) -> Vec<Box2> {
        let leaves = self.members.len();
        let none = Box2 {
            x: [0.0; 2],
            y: [0.0; 2],
        };
        let mut tree = vec![none; 2 * leaves];
        for (leaf, member) in self.members.iter().enumerate() {
            let [x, y] = settings[*member].field_nt(fields);
            tree[leaves + leaf] = Box2 {
                x: [x, x],
                y: [y, y],
            };
        }
        for node in (1..leaves).rev() {
            let (a, b) = (tree[2 * node], tree[2 * node + 1]);
            tree[node] = Box2 {
                x: [a.x[0].min(b.x[0]), a.x[1].max(b.x[1])],
                y: [a.y[0].min(b.y[0]), a.y[1].max(b.y[1])],
            };
        }
        tree
    }
}

/// Every choice of iron with the magnets as they stand.
fn as_they_stand(
    condition: &Condition<'_>,
    axes: &[AxisCandidates; 2],
    choices: &mut [Choice<'_>],
    front: &mut Front,
) {
    for choice in choices {
        let mut b = [0.0; 2];
        for axis in axes {
            let fields = axis.fields(condition.binnacle, &choice.iron);
            let more = axis.settings[0].field_nt(&fields);
            b = [b[0] + more[0], b[1] + more[1]];
        }
        let worst_deg = choice.objective.worst_deg(b);
        front.offer(choice.moves, worst_deg, || {
            setting(choice, &axes[0].settings[0], &axes[1].settings[0])
        });
    }
}

fn setting(choice: &Choice<'_>, fore_and_aft: &Magnets, athwartship: &Magnets) -> Setting {
    Setting {
        fore_and_aft: fore_and_aft.trays.clone(),
        athwartship: athwartship.trays.clone(),
        quadrantal: choice.soft.quadrantal.clone(),
        flinders: choice.soft.flinders.clone(),
        heeling: choice.heeling.clone(),
    }
}

/// Looks through the magnets of one choice of iron.
fn magnets(
    condition: &Condition<'_>,
    axes: &[AxisCandidates; 2],
    groups: &[Vec<Group>; 2],
    choice: &Choice<'_>,
    front: &mut Front,
) {
    let mut fields = None;
    let mut trees: [Vec<Option<Vec<Box2>>>; 2] = [0, 1].map(|a| vec![None; groups[a].len()]);
    for (i, one) in groups[0].iter().enumerate() {
        for (j, other) in groups[1].iter().enumerate() {
            let moves = choice.moves + one.moves + other.moves;
            if choice.bound_deg >= front.at(moves) - SLACK_DEG {
                continue;
            }
            let fields = fields.get_or_insert_with(|| {
                [0, 1].map(|a| axes[a].fields(condition.binnacle, &choice.iron))
            });
            trees[0][i].get_or_insert_with(|| one.tree(&axes[0].settings, &fields[0]));
            trees[1][j].get_or_insert_with(|| other.tree(&axes[1].settings, &fields[1]));
            let (Some(tree), Some(across)) = (&trees[0][i], &trees[1][j]) else {
                continue;
            };
            let leaf = |node: [usize; 2]| {
                (
                    &axes[0].settings[one.members[node[0] - one.members.len()]],
                    &axes[1].settings[other.members[node[1] - other.members.len()]],
                )
            };
            descend(
                choice,
                [tree, across],
                moves,
                stock(condition.binnacle),
                &leaf,
                front,
            );
        }
    }
}

/// Goes down both trees at once, the better half first.
fn descend<'m>(
    choice: &Choice<'_>,
    trees: [&[Box2]; 2],
    moves: u32,
    stock: Used,
    leaf: &impl Fn([usize; 2]) -> (&'m Magnets, &'m Magnets),
    front: &mut Front,
) {
    let bound = |node: [usize; 2]| {
        choice
            .objective
            .bound_deg(&sum(trees[0][node[0]], trees[1][node[1]]))
    };
    let leaves = trees.map(|tree| tree.len() / 2);
    let mut open = vec![([1, 1], bound([1, 1]))];
    while let Some((node, node_bound)) = open.pop() {
        if node_bound >= front.at(moves) - SLACK_DEG {
            continue;
        }
        if front.optimality.nodes >= MOST_NODES {
            front.left_out_deg = front.left_out_deg.min(node_bound.max(choice.bound_deg));
            continue;
        }
        front.optimality.nodes += 1;
        let at_leaf = [0, 1].map(|a| node[a] >= leaves[a]);
        if at_leaf == [true, true] {
            let (one, other) = leaf(node);
            if one.used.plus(other.used).plus(choice.used).within(stock) {
                let [one_box, other_box] = [trees[0][node[0]], trees[1][node[1]]];
                let b = [one_box.x[0] + other_box.x[0], one_box.y[0] + other_box.y[0]];
                let worst_deg = choice.objective.worst_deg(b);
                front.offer(moves, worst_deg, || setting(choice, one, other));
            }
            continue;
        }
        let wide = |a: usize| {
            if at_leaf[a] {
                -1.0
            } else {
                extent(trees[a][node[a]])
            }
        };
        let split = usize::from(wide(1) > wide(0));
        let mut children = [0, 1].map(|which| {
            let mut child = node;
            child[split] = 2 * node[split] + which;
            (child, bound(child))
        });
        // The last one in is the first out.
        if children[0].1 < children[1].1 {
            children.swap(0, 1);
        }
        open.extend(children);
    }
}

fn extent(within: Box2) -> f64 {
    (within.x[1] - within.x[0]).max(within.y[1] - within.y[0])
}

fn sum(one: Box2, other: Box2) -> Box2 {
    Box2 {
        x: [one.x[0] + other.x[0], one.x[1] + other.x[1]],
        y: [one.y[0] + other.y[0], one.y[1] + other.y[1]],
    }
}
