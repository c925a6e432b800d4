//! A plan as steps at the binnacle, each with what the compass will then show.
//!
//! The order is an adjuster's: Flinders bar, spheres, heeling magnets, fore-and-aft
//! magnets, athwartship magnets. What always holds: after every step the correctors
//! stand in a way that the binnacle and what is on board allow, and after the last as
//! the plan says. A step that finds its hole taken waits for the other tray, or takes
//! its own out first.

use super::condition::Condition;
use super::moves::matched;
use super::places::stands;
use super::reading_of_card::turn_sd_deg;
use super::tolerance::errors_between;
use super::{Adjustment, heeling};
use crate::berth::Alignment;
use crate::binnacle::{Axis, BarSetting, HeelingSetting, PairSetting, Setting, Side, Tray};
use crate::corrector::{Effect, effect};
use binnacle_compass::angle::{wrap_180, wrap_360};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Two-sided 99 % of a normal distribution: of a hundred right steps one is looked at
/// again.
pub(super) const NORMAL_99: f64 = 2.575_829;
/// No step is held to less, degrees.
const LEAST_TOLERANCE_DEG: f64 = 0.5;

/// What is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Corrector {
    /// The Flinders bar.
    Flinders,
    /// Spheres, boxes or plates.
    Quadrantal,
    /// The vertical magnets.
    Heeling,
    /// Fore-and-aft magnets.
    ForeAndAft,
    /// Athwartship magnets.
    Athwartship,
}

/// What is done with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// It comes in.
    Fit,
    /// It comes out.
    TakeOut,
    /// It comes to another place as it is.
    Move,
    /// It, or its magnets, are turned or exchanged, perhaps also moved.
    Change,
}

/// Where something stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "place", rename_all = "snake_case")]
pub enum Place {
    /// Magnets of an axis.
    Magnets(Tray),
    /// Spheres, boxes or plates.
    Pair(PairSetting),
    /// A Flinders bar.
    Bar(BarSetting),
    /// Vertical magnets.
    Bucket(HeelingSetting),
}

/// One movement, to be checked on the spot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// From 1.
    pub number: u32,
    /// What is moved.
    pub corrector: Corrector,
    /// What is done with it.
    pub action: Action,
    /// Where it was; none when it comes in.
    pub from: Option<Place>,
    /// Where it will be; none when it comes out.
    pub to: Option<Place>,
    /// All of it in a sentence.
    pub words: String,
    /// What to see to before.
    pub check: Option<String>,
    /// What the compass will then read at the berth, degrees.
    pub expected_compass_deg: f64,
    /// By how much it will have turned, degrees, clockwise positive.
    pub change_deg: f64,
    /// How far off it may be, degrees.
    pub tolerance_deg: f64,
    /// Whether on this heading the compass shows the step at all.
    pub seen: bool,
    /// How the correctors stood before.
    pub setting_before: Setting,
    /// How they stand then.
    pub setting_after: Setting,
}

impl Step {
    /// Whether what it moved is where it was to be by one setting, and not by another.
    pub fn is_gainsaid(&self, taken: &Setting, said: &Setting) -> bool {
        let is_done = |setting: &Setting| match (&self.to, &self.from) {
            (Some(to), _) => stands(setting, self.corrector, to),
            (None, Some(from)) => !stands(setting, self.corrector, from),
            (None, None) => true,
        };
        is_done(taken) && !is_done(said)
    }
}

pub(super) fn steps(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    to: &Setting,
) -> Vec<Step> {
    let start = adjustment.standing();
    let first_deg = adjustment.compass_deg.unwrap_or_else(|| {
        compass_at_berth(adjustment, condition, &effect(condition.binnacle, start))
    });
    let mut steps = Vec::new();
    let mut before = start.clone();
    let mut shown_deg = first_deg;
    for (corrector, after) in sequence(condition, start, to) {
        let number = steps.len() as u32 + 1;
        let step = step(
            adjustment, condition, number, corrector, before, after, shown_deg,
        );
        shown_deg = step.expected_compass_deg;
        before = step.setting_after.clone();
        steps.push(step);
    }
    steps
}

/// What the compass reads at the berth with correctors of this effect, degrees.
pub(super) fn compass_at_berth(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    effect: &Effect,
) -> f64 {
    let reading = adjustment.reading;
    let aligned_deg = match reading.alignment() {
        Alignment::Keel => 0.0,
        Alignment::AsFitted => condition.constant_deg(),
    };
    let magnetic_deg = reading.magnetic().degrees() - aligned_deg;
    let ship = condition.with_effect(effect, adjustment.earth.h_nt);
    let deviation = ship.deviation_rad(magnetic_deg.to_radians(), adjustment.earth);
    wrap_360(magnetic_deg - deviation.to_degrees())
}

/// By how much the compass turns at the berth from one setting to another, degrees,
/// and the standard error of that.
pub(super) fn change_deg(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    before: &Setting,
    after: &Setting,
) -> (f64, f64) {
    let of = |effect: &Effect| compass_at_berth(adjustment, condition, effect);
    let [old, new] = [before, after].map(|setting| effect(condition.binnacle, setting));
    let shown = of(&new);
    let change = wrap_180(shown - of(&old));
    let errors = errors_between(condition.binnacle, before, after);
    let variance: f64 = errors
        .iter()
        .map(|error| wrap_180(of(&new.plus(error)) - shown).powi(2))
        .sum();
    let of_lambda = change * condition.lambda_sd_share();
    (change, variance.sqrt().hypot(of_lambda))
}

/// How far off a turn may be that is known to so much, degrees, in a horizontal field
/// of so many nT.
pub(super) fn tolerance_deg(sd_deg: f64, h_nt: f64) -> f64 {
    let tolerance_deg = NORMAL_99 * sd_deg.hypot(turn_sd_deg(h_nt));
    tolerance_deg.max(LEAST_TOLERANCE_DEG)
}

fn step(
    adjustment: &Adjustment<'_>,
    condition: &Condition<'_>,
    number: u32,
    moved: (Corrector, Option<Place>, Option<Place>),
    before: Setting,
    after: Setting,
    shown_deg: f64,
) -> Step {
    let (corrector, from, to) = moved;
    let (change_deg, sd_deg) = change_deg(adjustment, condition, &before, &after);
    let tolerance_deg = tolerance_deg(sd_deg, adjustment.earth.h_nt);
    let action = action(from.as_ref(), to.as_ref());
    Step {
        number,
        corrector,
        action,
        words: words(condition, corrector, from.as_ref(), to.as_ref()),
        check: match corrector {
            Corrector::Heeling => heeling::check(adjustment, condition, &before, &after),
            // What comes out shows nothing of its own any more.
            _ => to.as_ref().and_then(|_| retentive(corrector)),
        },
        from,
        to,
        expected_compass_deg: wrap_360(shown_deg + change_deg),
        change_deg,
        tolerance_deg,
        seen: change_deg.abs() > tolerance_deg,
        setting_before: before,
        setting_after: after,
    }
}

type Moved = (Corrector, Option<Place>, Option<Place>);

/// What is moved in which order, and how the correctors stand after each.
fn sequence(condition: &Condition<'_>, from: &Setting, to: &Setting) -> Vec<(Moved, Setting)> {
    let mut all = Vec::new();
    let mut now = from.clone();
    if from.flinders != to.flinders {
        now.flinders.clone_from(&to.flinders);
        let places = [from, to].map(|s| s.flinders.clone().map(Place::Bar));
        all.push((moved(Corrector::Flinders, places), now.clone()));
    }
    if from.quadrantal != to.quadrantal {
        now.quadrantal.clone_from(&to.quadrantal);
        let places = [from, to].map(|s| s.quadrantal.clone().map(Place::Pair));
        all.push((moved(Corrector::Quadrantal, places), now.clone()));
    }
    if from.heeling != to.heeling {
        now.heeling.clone_from(&to.heeling);
        let places = [from, to].map(|s| s.heeling.clone().map(Place::Bucket));
        all.push((moved(Corrector::Heeling, places), now.clone()));
    }
    let mut pending: Vec<(Axis, Option<Tray>, Option<Tray>)> = Vec::new();
    for axis in Axis::BOTH {
        for (old, new) in matched(from.trays(axis), to.trays(axis)) {
            if old != new {
                pending.push((axis, old.cloned(), new.cloned()));
            }
        }
    }
    // Without the empty hands of those that come out others could not come in.
    pending.sort_by_key(|(axis, _, new)| (*axis, new.is_some()));
    while !pending.is_empty() {
        let possible = pending.iter().position(|(axis, old, new)| {
            let after = replaced(&now, *axis, old.as_ref(), new.as_ref());
            condition.binnacle.with_setting(after).is_ok()
        });
        let (axis, old, new) = if let Some(index) = possible {
            pending.remove(index)
        } else {
            let (axis, old, new) = pending.remove(0);
            // Taken out, it lets another one in, and waits itself.
            pending.push((axis, None, new.clone()));
            if old.is_none() {
                break;
            }
            (axis, old, None)
        };
        now = replaced(&now, axis, old.as_ref(), new.as_ref());
        let corrector = match axis {
            Axis::ForeAndAft => Corrector::ForeAndAft,
            Axis::Athwartship => Corrector::Athwartship,
        };
        let places = [old, new].map(|tray| tray.map(Place::Magnets));
        all.push((moved(corrector, places), now.clone()));
    }
    all
}

fn moved(corrector: Corrector, [from, to]: [Option<Place>; 2]) -> Moved {
    (corrector, from, to)
}

fn replaced(now: &Setting, axis: Axis, old: Option<&Tray>, new: Option<&Tray>) -> Setting {
    let mut after = now.clone();
    let trays = after.trays_mut(axis);
    trays.retain(|tray| Some(tray) != old);
    trays.extend(new.cloned());
    trays.sort_by_key(|tray| tray.hole);
    after
}

fn action(from: Option<&Place>, to: Option<&Place>) -> Action {
    match (from, to) {
        (None, _) => Action::Fit,
        (_, None) => Action::TakeOut,
        (Some(Place::Magnets(a)), Some(Place::Magnets(b)))
            if a.count == b.count && a.magnet == b.magnet && a.red == b.red =>
        {
            Action::Move
        }
        (Some(Place::Pair(a)), Some(Place::Pair(b))) if a.size == b.size => Action::Move,
        (Some(Place::Bucket(a)), Some(Place::Bucket(b)))
            if a.count == b.count && a.red == b.red =>
        {
            Action::Move
        }
        _ => Action::Change,
    }
}

fn retentive(corrector: Corrector) -> Option<String> {
    let words = match corrector {
        Corrector::Flinders => {
            "before it goes in, hold each piece upright beside the card, then the other end up: \
             the card must come to rest where it did; a piece that turns it by more than 1 degree \
             holds magnetism of its own and is exchanged or annealed"
        }
        Corrector::Quadrantal => {
            "when they stand, turn each by a quarter and by half about its own axis: a card that \
             moves by more than 1 degree shows magnetism of its own, and that one is exchanged or \
             annealed before a magnet is touched"
        }
        _ => return None,
    };
    Some(words.to_owned())
}

fn words(
    condition: &Condition<'_>,
    corrector: Corrector,
    from: Option<&Place>,
    to: Option<&Place>,
) -> String {
    let place = |place: &Place| said(condition, corrector, place);
    match (from.map(place), to.map(place)) {
        (Some(from), Some(to)) => format!("{corrector}: from {from} to {to}"),
        (None, Some(to)) => format!("{corrector}: fit {to}"),
        (Some(from), None) => format!("{corrector}: take out {from}"),
        (None, None) => corrector.to_string(),
    }
}

fn said(condition: &Condition<'_>, corrector: Corrector, place: &Place) -> String {
    let design = &condition.binnacle.design;
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
                crate::binnacle::Carrier::Hole => "hole",
                crate::binnacle::Carrier::Tray => "tray at hole",
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
            let pieces = condition.binnacle.bar_lengths();
            let pieces = pieces
                .iter()
                .find(|(l, _)| crate::binnacle::nearly_equal(*l, bar.length_mm));
            let pieces = pieces.map_or_else(Vec::new, |(_, pieces)| pieces.clone());
            let pieces: Vec<String> = pieces.iter().map(f64::to_string).collect();
            let side = match bar.side {
                Side::Forward => "forward of",
                Side::Aft => "abaft",
            };
            // Clockwise from abaft is to port.
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

impl fmt::Display for Corrector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Corrector::Flinders => "Flinders bar",
            Corrector::Quadrantal => "quadrantal correctors",
            Corrector::Heeling => "heeling magnets",
            Corrector::ForeAndAft => "fore-and-aft magnets",
            Corrector::Athwartship => "athwartship magnets",
        })
    }
}
