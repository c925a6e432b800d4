//! How the correctors stand, and whether they can stand so.

use super::BinnacleForm;
use super::design::{DesignForm, Hole, Side};
use super::error::BinnacleError;
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// Where every corrector stands; an empty list or null is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setting {
    /// Fore-and-aft magnets, a hole each.
    #[serde(default)]
    pub fore_and_aft: Vec<Tray>,
    /// Athwartship magnets, a hole each.
    #[serde(default)]
    pub athwartship: Vec<Tray>,
    /// Spheres, boxes or plates.
    #[serde(default)]
    pub quadrantal: Option<PairSetting>,
    /// The Flinders bar.
    #[serde(default)]
    pub flinders: Option<BarSetting>,
    /// The vertical magnets.
    #[serde(default)]
    pub heeling: Option<HeelingSetting>,
}

/// Which way magnets lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Along the keel.
    ForeAndAft,
    /// Across it.
    Athwartship,
}

/// Where the red, north-seeking end points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Red {
    /// To the bow.
    Forward,
    /// To the stern.
    Aft,
    /// To starboard.
    Starboard,
    /// To port.
    Port,
    /// Upwards.
    Up,
    /// Downwards.
    Down,
}

/// Magnets in one hole or tray.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tray {
    /// Number of the hole, from the bottom.
    #[serde(deserialize_with = "numbered")]
    pub hole: u16,
    /// Their kind.
    pub magnet: String,
    /// How many.
    pub count: u8,
    /// Where their red ends point.
    pub red: Red,
}

/// A pair of spheres, boxes or plates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairSetting {
    /// Name of the size.
    pub size: String,
    /// Position on the scale, mm.
    pub mark_mm: f64,
    /// Degrees clockwise from athwartships, seen from above.
    #[serde(default)]
    pub slew_deg: f64,
}

/// A Flinders bar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BarSetting {
    /// Length of all its pieces, mm.
    pub length_mm: f64,
    /// On which side of the card.
    pub side: Side,
    /// Degrees clockwise from there, seen from above.
    #[serde(default)]
    pub slew_deg: f64,
}

/// Magnets in the bucket.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeelingSetting {
    /// Number of its position, from the bottom.
    #[serde(deserialize_with = "numbered")]
    pub position: u16,
    /// How many magnets.
    pub count: u8,
    /// Where their red ends point: up or down.
    pub red: Red,
}

/// The soft iron of a setting: what is set before the magnets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soft {
    /// Spheres, boxes or plates.
    pub quadrantal: Option<PairSetting>,
    /// The Flinders bar.
    pub flinders: Option<BarSetting>,
}

impl Axis {
    /// Both, in the order in which they are set.
    pub const BOTH: [Axis; 2] = [Axis::ForeAndAft, Axis::Athwartship];

    /// Red forward or to starboard for 1, aft or to port for −1.
    pub fn red(self, positive: bool) -> Red {
        match (self, positive) {
            (Axis::ForeAndAft, true) => Red::Forward,
            (Axis::ForeAndAft, false) => Red::Aft,
            (Axis::Athwartship, true) => Red::Starboard,
            (Axis::Athwartship, false) => Red::Port,
        }
    }
}

impl Red {
    /// Sign along the ship's axes: forward, starboard and down are positive.
    pub fn sign(self) -> f64 {
        match self {
            Red::Forward | Red::Starboard | Red::Down => 1.0,
            Red::Aft | Red::Port | Red::Up => -1.0,
        }
    }

    /// The other end.
    pub fn reversed(self) -> Red {
        match self {
            Red::Forward => Red::Aft,
            Red::Aft => Red::Forward,
            Red::Starboard => Red::Port,
            Red::Port => Red::Starboard,
            Red::Up => Red::Down,
            Red::Down => Red::Up,
        }
    }
}

impl Setting {
    /// The magnets of an axis.
    pub fn trays(&self, axis: Axis) -> &Vec<Tray> {
        match axis {
            Axis::ForeAndAft => &self.fore_and_aft,
            Axis::Athwartship => &self.athwartship,
        }
    }

    /// The magnets of an axis, to change.
    pub fn trays_mut(&mut self, axis: Axis) -> &mut Vec<Tray> {
        match axis {
            Axis::ForeAndAft => &mut self.fore_and_aft,
            Axis::Athwartship => &mut self.athwartship,
        }
    }

    /// Its soft iron.
    pub fn soft(&self) -> Soft {
        Soft {
            quadrantal: self.quadrantal.clone(),
            flinders: self.flinders.clone(),
        }
    }
}

/// A number of a hole or position; what cannot be one is said in an adjuster's words.
fn numbered<'de, D: Deserializer<'de>>(from: D) -> Result<u16, D::Error> {
    let number = i64::deserialize(from)?;
    u16::try_from(number).map_err(|_| {
        let what = format!("there is no {number}: holes and positions are numbered from 1");
        serde::de::Error::custom(what)
    })
}

/// Whether two lengths or angles of a form are the same one.
pub(crate) fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6
}

/// Whether a setting is one of this binnacle, with what is on board.
pub(super) fn check(form: &BinnacleForm, setting: &Setting) -> Result<(), BinnacleError> {
    for axis in Axis::BOTH {
        trays(form, axis, setting.trays(axis))?;
    }
    if let Some(pair) = &setting.quadrantal {
        check_pair(form, pair)?;
    }
    if let Some(bar) = &setting.flinders {
        check_bar(form, bar)?;
    }
    if let Some(heeling) = &setting.heeling {
        check_heeling(&form.design, heeling)?;
    }
    for lot in &form.design.magnets {
        let (used, aboard) = (
            used(form, setting, &lot.name),
            form.magnets_aboard(&lot.name),
        );
        if used > aboard {
            let what = format!(
                "{used} magnets {:?} are set and {aboard} on board",
                lot.name
            );
            return Err(BinnacleError::new("aboard.magnets", what));
        }
    }
    Ok(())
}

/// How many magnets of a kind a setting uses.
fn used(form: &BinnacleForm, setting: &Setting, kind: &str) -> u16 {
    let trays = setting.fore_and_aft.iter().chain(&setting.athwartship);
    let trays = trays.filter(|tray| tray.magnet == kind);
    let heeling = form.design.heeling.as_ref().filter(|h| h.magnet == kind);
    let heeling = heeling.and(setting.heeling.as_ref());
    trays.map(|tray| u16::from(tray.count)).sum::<u16>() + heeling.map_or(0, |h| u16::from(h.count))
}

fn trays(form: &BinnacleForm, axis: Axis, trays: &[Tray]) -> Result<(), BinnacleError> {
    let rack = form.design.rack(axis);
    let field = |index: usize, part: &str| format!("setting.{axis}[{index}].{part}");
    if trays.len() > usize::from(rack.at_once) {
        let what = format!("{} hold magnets, of {} at once", trays.len(), rack.at_once);
        return Err(BinnacleError::new(format!("setting.{axis}"), what));
    }
    for (index, tray) in trays.iter().enumerate() {
        place_there(&field(index, "hole"), "hole", tray.hole, &rack.holes)?;
        if trays[..index].iter().any(|other| other.hole == tray.hole) {
            let what = format!("hole {} holds magnets already", tray.hole);
            return Err(BinnacleError::new(field(index, "hole"), what));
        }
        if !rack.magnets.contains(&tray.magnet) {
            let what = format!("no magnets {:?} fit there", tray.magnet);
            return Err(BinnacleError::new(field(index, "magnet"), what));
        }
        if !(1..=rack.magnets_each).contains(&tray.count) {
            let what = format!("{} where 1 to {} fit", tray.count, rack.magnets_each);
            return Err(BinnacleError::new(field(index, "count"), what));
        }
        if ![axis.red(true), axis.red(false)].contains(&tray.red) {
            let [one, other] = [axis.red(true), axis.red(false)];
            let what = format!("{} where it is {one} or {other}", tray.red);
            return Err(BinnacleError::new(field(index, "red"), what));
        }
    }
    Ok(())
}

fn place_there(field: &str, what: &str, number: u16, holes: &[Hole]) -> Result<(), BinnacleError> {
    if holes.iter().any(|hole| hole.number == number) {
        return Ok(());
    }
    let what = format!(
        "there is no {what} {number}: they are numbered 1 to {}",
        holes.len()
    );
    Err(BinnacleError::new(field, what))
}

fn check_pair(form: &BinnacleForm, pair: &PairSetting) -> Result<(), BinnacleError> {
    let field = |part: &str| format!("setting.quadrantal.{part}");
    let Some(iron) = &form.design.quadrantal else {
        let what = "the type has no quadrantal correctors";
        return Err(BinnacleError::new("setting.quadrantal", what));
    };
    if !form.aboard.quadrantal.contains(&pair.size) {
        let what = format!("no pair {:?} is on board", pair.size);
        return Err(BinnacleError::new(field("size"), what));
    }
    if !iron
        .marks
        .iter()
        .any(|mark| same(mark.mark_mm, pair.mark_mm))
    {
        let what = format!("the scale has no mark {} mm", pair.mark_mm);
        return Err(BinnacleError::new(field("mark_mm"), what));
    }
    slew_there(&field("slew_deg"), pair.slew_deg, &iron.slews_deg)
}

fn slew_there(field: &str, slew_deg: f64, slews_deg: &[f64]) -> Result<(), BinnacleError> {
    if slews_deg.iter().any(|slew| same(*slew, slew_deg)) {
        return Ok(());
    }
    let what = format!("the bracket does not turn to {slew_deg} degrees");
    Err(BinnacleError::new(field, what))
}

fn check_bar(form: &BinnacleForm, bar: &BarSetting) -> Result<(), BinnacleError> {
    let field = |part: &str| format!("setting.flinders.{part}");
    let Some(holder) = &form.design.flinders else {
        return Err(BinnacleError::new(
            "setting.flinders",
            "the type has no Flinders bar",
        ));
    };
    if !form
        .bar_lengths()
        .iter()
        .any(|(length, _)| same(*length, bar.length_mm))
    {
        let what = format!("no pieces on board make {} mm", bar.length_mm);
        return Err(BinnacleError::new(field("length_mm"), what));
    }
    if !holder.sides.contains(&bar.side) {
        let what = format!("the holder is not {} of the card", bar.side);
        return Err(BinnacleError::new(field("side"), what));
    }
    slew_there(&field("slew_deg"), bar.slew_deg, &holder.slews_deg)
}

fn check_heeling(design: &DesignForm, set: &HeelingSetting) -> Result<(), BinnacleError> {
    let field = |part: &str| format!("setting.heeling.{part}");
    let Some(bucket) = &design.heeling else {
        return Err(BinnacleError::new(
            "setting.heeling",
            "the type has no heeling bucket",
        ));
    };
    place_there(
        &field("position"),
        "position",
        set.position,
        &bucket.positions,
    )?;
    if !(1..=bucket.at_most).contains(&set.count) {
        let what = format!("{} where 1 to {} fit", set.count, bucket.at_most);
        return Err(BinnacleError::new(field("count"), what));
    }
    if ![Red::Up, Red::Down].contains(&set.red) {
        let what = format!("{} where it is up or down", set.red);
        return Err(BinnacleError::new(field("red"), what));
    }
    Ok(())
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Axis::ForeAndAft => "fore_and_aft",
            Axis::Athwartship => "athwartship",
        })
    }
}

impl fmt::Display for Red {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Red::Forward => "forward",
            Red::Aft => "aft",
            Red::Starboard => "starboard",
            Red::Port => "port",
            Red::Up => "up",
            Red::Down => "down",
        })
    }
}
