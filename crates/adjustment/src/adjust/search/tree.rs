//! Trees of magnet settings for branch and bound.

use super::candidates::{AxisCandidates, AxisSetting};
use super::objective::FieldBox;
use crate::adjust::state::MagneticState;
use crate::corrector::{Iron, Vector};

/// Magnets of one axis with the same number of moves, as a tree whose node i has the
/// children 2i and 2i + 1, and whose leaves are the second half.
pub(crate) struct Group {
    pub(crate) moves: u32,
    /// Indices of settings, sorted by their field without soft iron.
    members: Vec<usize>,
}

impl Group {
    pub(crate) fn by_moves(state: &MagneticState<'_>, axis: &AxisCandidates) -> Vec<Group> {
        let fields = axis.fields(state.binnacle, &Iron::default());
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

    pub(crate) fn tree(&self, settings: &[AxisSetting], fields: &[Vector]) -> Vec<FieldBox> {
        let leaves = self.members.len();
        let none = FieldBox {
            x: [0.0; 2],
            y: [0.0; 2],
        };
        let mut tree = vec![none; 2 * leaves];
        for (leaf, member) in self.members.iter().enumerate() {
            let [x, y] = settings[*member].field_nt(fields);
            tree[leaves + leaf] = FieldBox {
                x: [x, x],
                y: [y, y],
            };
        }
        for node in (1..leaves).rev() {
            let (a, b) = (tree[2 * node], tree[2 * node + 1]);
            tree[node] = FieldBox {
                x: [a.x[0].min(b.x[0]), a.x[1].max(b.x[1])],
                y: [a.y[0].min(b.y[0]), a.y[1].max(b.y[1])],
            };
        }
        tree
    }
}

/// A group of each axis, with their trees.
pub(crate) struct Pair<'p> {
    pub(crate) groups: [&'p Group; 2],
    pub(crate) trees: [&'p [FieldBox]; 2],
    pub(crate) moves: u32,
}

impl Pair<'_> {
    pub(crate) fn within(&self, node: [usize; 2]) -> FieldBox {
        let [one, other] = [self.trees[0][node[0]], self.trees[1][node[1]]];
        FieldBox {
            x: [one.x[0] + other.x[0], one.x[1] + other.x[1]],
            y: [one.y[0] + other.y[0], one.y[1] + other.y[1]],
        }
    }

    /// Returns the setting at a leaf of one axis.
    pub(crate) fn leaf(&self, axis: usize, node: usize) -> Option<usize> {
        let members = &self.groups[axis].members;
        node.checked_sub(members.len()).map(|leaf| members[leaf])
    }

    /// Returns the axis whose node should be split.
    pub(crate) fn wider(&self, node: [usize; 2]) -> usize {
        let wide = |axis: usize| match self.leaf(axis, node[axis]) {
            Some(_) => -1.0,
            None => self.trees[axis][node[axis]].extent(),
        };
        usize::from(wide(1) > wide(0))
    }
}
