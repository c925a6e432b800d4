//! Wording of the steps.

use super::step::{Corrector, Place};
use crate::adjust::state::MagneticState;
use crate::binnacle::{Carrier, Side, Tray, nearly_equal};

pub(crate) fn retentive_check(corrector: Corrector) -> Option<String> {
    let words = match corrector {
        Corrector::Flinders => {
            "before it goes in, hold each piece upright beside the card, then the other end up: \
             the card must come to rest on the same heading; exchange or anneal a piece that turns \
             it by more than 1 degree, because it is permanently magnetised"
        }
        Corrector::Quadrantal => {
            "when they are fitted, turn each by a quarter and a half turn about its own axis: if \
             the card moves by more than 1 degree, that one is permanently magnetised; exchange or \
             anneal it before any magnet is touched"
        }
        _ => return None,
    };
    Some(words.to_owned())
}

pub(crate) fn describe_movement(
    state: &MagneticState<'_>,
    corrector: Corrector,
    from: Option<&Place>,
    to: Option<&Place>,
) -> String {
    let place = |place: &Place| describe_place(state, corrector, place);
    match (from.map(place), to.map(place)) {
        (Some(from), Some(to)) => format!("{corrector}: from {from} to {to}"),
        (None, Some(to)) => format!("{corrector}: fit {to}"),
        (Some(from), None) => format!("{corrector}: take out {from}"),
        (None, None) => corrector.to_string(),
    }
}

fn describe_place(state: &MagneticState<'_>, corrector: Corrector, place: &Place) -> String {
    let design = &state.binnacle.design;
    match place {
        Place::Magnets(tray) => {
            let rack = match corrector {
                Corrector::Athwartship => &design.athwartship,
                _ => &design.fore_and_aft,
            };
            let Tray {
                hole,
                magnet,
                count,
                red,
            } = tray;
            let carrier = match rack.carrier {
                Carrier::Hole => "hole",
                Carrier::Tray => "tray at hole",
            };
            format!("{carrier} {hole} with {count} of {magnet}, red {red}")
        }
        Place::Pair(pair) => {
            let slew = match pair.slew_deg {
                none if none.abs() < 1e-6 => String::new(),
                slew if slew > 0.0 => format!(", starboard one {slew} degrees aft"),
                slew => format!(", starboard one {} degrees forward", -slew),
            };
            format!("{} at {} mm{slew}", pair.size, pair.mark_mm)
        }
        Place::Bar(bar) => {
            let pieces = state.binnacle.bar_lengths();
            let pieces = pieces.iter().find(|(l, _)| nearly_equal(*l, bar.length_mm));
            let pieces = pieces.map_or_else(Vec::new, |(_, pieces)| pieces.clone());
            let pieces: Vec<String> = pieces.iter().map(f64::to_string).collect();
            let side = match bar.side {
                Side::Forward => "forward of",
                Side::Aft => "abaft",
            };
            // Clockwise from aft is to port.
            let to_starboard = match bar.side {
                Side::Forward => bar.slew_deg,
                Side::Aft => -bar.slew_deg,
            };
            let slew = match to_starboard {
                none if none.abs() < 1e-6 => String::new(),
                slew if slew > 0.0 => format!(", {slew} degrees to starboard"),
                slew => format!(", {} degrees to port", -slew),
            };
            format!(
                "{} mm ({}; spacers of wood or brass fill the tube below, so that its top stands \
                 at the card's height) {side} the card{slew}",
                bar.length_mm,
                match &pieces[..] {
                    [_] => "one piece".to_owned(),
                    _ => format!("{} mm, the longest on top", pieces.join(" + ")),
                }
            )
        }
        Place::Bucket(set) => {
            format!(
                "position {} with {}, red {}",
                set.position, set.count, set.red
            )
        }
    }
}
