//! Choices of soft iron.

use crate::adjust::corrector_moves;
use crate::adjust::state::MagneticState;
use crate::binnacle::{BarSetting, Binnacle, PairSetting, Setting, Soft};

/// Lists all choices of soft iron, with the moves from the present one.
pub(crate) fn iron(state: &MagneticState<'_>, standing: &Setting) -> Vec<(Soft, u32)> {
    let binnacle = state.binnacle;
    let pairs = pairs(binnacle, standing);
    let bars = bars(state, standing);
    let mut all = Vec::with_capacity(pairs.len() * bars.len());
    for pair in &pairs {
        let pair_moves = corrector_moves::pair_moves(standing.quadrantal.as_ref(), pair.as_ref());
        for bar in &bars {
            let soft = Soft {
                quadrantal: pair.clone(),
                flinders: bar.clone(),
            };
            let bar_moves = corrector_moves::bar_moves(standing.flinders.as_ref(), bar.as_ref());
            all.push((soft, pair_moves + bar_moves));
        }
    }
    all
}

fn pairs(binnacle: &Binnacle, standing: &Setting) -> Vec<Option<PairSetting>> {
    let Some(iron) = &binnacle.design.quadrantal else {
        return vec![standing.quadrantal.clone()];
    };
    let mut all = vec![None];
    let is_on_board = |name: &String| binnacle.inventory.quadrantal.contains(name);
    for size in iron.sizes.iter().filter(|size| is_on_board(&size.name)) {
        for mark in &iron.marks {
            for slew_deg in &iron.slews_deg {
                all.push(Some(PairSetting {
                    size: size.name.clone(),
                    mark_mm: mark.mark_mm,
                    slew_deg: *slew_deg,
                }));
            }
        }
    }
    all
}

/// Lists the bars. A bar corrects only the induced field: one that leaves more of it than
/// the present one would exchange a permanent field for one that changes sign with the
/// hemisphere, however good it looks in the known waters.
fn bars(state: &MagneticState<'_>, standing: &Setting) -> Vec<Option<BarSetting>> {
    let binnacle = state.binnacle;
    let may_move = state.may_move_bar;
    let Some(holder) = binnacle.design.flinders.as_ref().filter(|_| may_move) else {
        return vec![standing.flinders.clone()];
    };
    let mut all = vec![None];
    for (length_mm, _) in binnacle.bar_lengths() {
        for side in &holder.sides {
            for slew_deg in &holder.slews_deg {
                all.push(Some(BarSetting {
                    length_mm,
                    side: *side,
                    slew_deg: *slew_deg,
                }));
            }
        }
    }
    let left_now = state.left_to_induction(standing.flinders.as_ref());
    all.retain(|bar| {
        *bar == standing.flinders || state.left_to_induction(bar.as_ref()) <= left_now
    });
    all
}
