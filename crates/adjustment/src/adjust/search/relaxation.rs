//! Bounds of untried settings.

use super::objective::{FieldBox, Objective};

/// Greatest number of nodes: about a second of one core.
const MOST_RELAXED: u64 = 200_000;
/// Smallest box of the continuum that is divided, nT.
const SMALLEST_NT: f64 = 2.0;
/// Size below which a box is bounded on every heading, nT.
const SMALL_NT: f64 = 300.0;

/// Bounds the residual with magnets of any field within a box, at most the known bound,
/// degrees.
pub(crate) fn relaxed_within(
    objective: &Objective<'_>,
    within: FieldBox,
    mut left_deg: f64,
    nodes: &mut u64,
) -> f64 {
    let bound = |within: &FieldBox| {
        if within.extent() < SMALL_NT {
            objective.fine_bound_deg(within)
        } else {
            objective.bound_deg(within)
        }
    };
    let mut open = vec![(within, bound(&within))];
    while let Some((within, bound_deg)) = open.pop() {
        if bound_deg >= left_deg {
            continue;
        }
        *nodes += 1;
        if within.extent() < SMALLEST_NT || *nodes >= MOST_RELAXED {
            left_deg = bound_deg;
            continue;
        }
        let mut halves = halved(within).map(|half| (half, bound(&half)));
        // The stack's last entry comes first.
        if halves[0].1 < halves[1].1 {
            halves.swap(0, 1);
        }
        open.extend(halves);
    }
    left_deg
}

fn halved(within: FieldBox) -> [FieldBox; 2] {
    let along_x = within.x[1] - within.x[0] >= within.y[1] - within.y[0];
    let [low, high] = if along_x { within.x } else { within.y };
    let middle = f64::midpoint(low, high);
    [[low, middle], [middle, high]].map(|part| {
        if along_x {
            FieldBox { x: part, ..within }
        } else {
            FieldBox { y: part, ..within }
        }
    })
}
