//! Number of moves from one setting to another.

use crate::binnacle::{BarSetting, HeelingSetting, PairSetting, Tray, nearly_equal};

/// Counts the moves of the magnets of one axis, with the cheapest pairing of trays.
pub(crate) fn tray_moves(from: &[Tray], to: &[Tray]) -> u32 {
    match_trays(from, to)
        .iter()
        .map(|pair| moves_of_tray(pair.0, pair.1))
        .sum()
}

/// Pairs the trays before and after with the fewest moves.
pub(crate) fn match_trays<'t>(
    from: &'t [Tray],
    to: &'t [Tray],
) -> Vec<(Option<&'t Tray>, Option<&'t Tray>)> {
    let size = from.len().max(to.len());
    let mut order: Vec<usize> = (0..size).collect();
    let mut best: Option<(u32, Vec<usize>)> = None;
    permute(&mut order, 0, &mut |order| {
        let cost = order
            .iter()
            .enumerate()
            .map(|(before, after)| moves_of_tray(from.get(before), to.get(*after)))
            .sum();
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, order.to_vec()));
        }
    });
    let order = best.map_or_else(Vec::new, |(_, order)| order);
    let pairs = order.iter().enumerate();
    pairs
        .map(|(before, after)| (from.get(before), to.get(*after)))
        .collect()
}

fn permute(order: &mut [usize], fixed: usize, visit: &mut impl FnMut(&[usize])) {
    if fixed == order.len() {
        visit(order);
        return;
    }
    for index in fixed..order.len() {
        order.swap(fixed, index);
        permute(order, fixed + 1, visit);
        order.swap(fixed, index);
    }
}

fn moves_of_tray(from: Option<&Tray>, to: Option<&Tray>) -> u32 {
    match (from, to) {
        (None, None) => 0,
        (None, Some(_)) | (Some(_), None) => 1,
        (Some(from), Some(to)) => {
            let magnets = from.count != to.count || from.magnet != to.magnet;
            u32::from(from.hole != to.hole) + u32::from(magnets) + u32::from(from.red != to.red)
        }
    }
}

pub(crate) fn pair_moves(from: Option<&PairSetting>, to: Option<&PairSetting>) -> u32 {
    match (from, to) {
        (None, None) => 0,
        (None, Some(_)) | (Some(_), None) => 1,
        (Some(from), Some(to)) if from.size != to.size => {
            2 + u32::from(!nearly_equal(from.slew_deg, to.slew_deg))
        }
        (Some(from), Some(to)) => {
            u32::from(!nearly_equal(from.mark_mm, to.mark_mm))
                + u32::from(!nearly_equal(from.slew_deg, to.slew_deg))
        }
    }
}

pub(crate) fn bar_moves(from: Option<&BarSetting>, to: Option<&BarSetting>) -> u32 {
    match (from, to) {
        (None, None) => 0,
        (None, Some(_)) | (Some(_), None) => 1,
        (Some(from), Some(to)) => {
            u32::from(!nearly_equal(from.length_mm, to.length_mm))
                + u32::from(from.side != to.side)
                + u32::from(!nearly_equal(from.slew_deg, to.slew_deg))
        }
    }
}

pub(crate) fn heeling_moves(from: Option<&HeelingSetting>, to: Option<&HeelingSetting>) -> u32 {
    u32::from(from != to)
}
