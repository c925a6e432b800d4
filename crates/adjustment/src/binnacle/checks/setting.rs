//! Validation of a setting.

use crate::binnacle::axis::{Axis, Red};
use crate::binnacle::binnacle_form::BinnacleForm;
use crate::binnacle::design::{DesignForm, Hole};
use crate::binnacle::error::BinnacleError;
use crate::binnacle::nearly_equal::nearly_equal;
use crate::binnacle::setting::{BarSetting, HeelingSetting, PairSetting, Setting, Tray};

/// Checks that a setting is possible with this binnacle and the correctors on board.
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
        let (used, available) = (used(form, setting, &lot.name), form.magnet_count(&lot.name));
        if used > available {
            let what = format!(
                "{used} magnets {:?} are set, but {available} are on board",
                lot.name
            );
            return Err(BinnacleError::new("aboard.magnets", what));
        }
    }
    Ok(())
}

/// Counts the magnets of a kind that a setting uses.
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
        let what = format!(
            "{} hold magnets; at most {} can at once",
            trays.len(),
            rack.at_once
        );
        return Err(BinnacleError::new(format!("setting.{axis}"), what));
    }
    for (index, tray) in trays.iter().enumerate() {
        place_there(&field(index, "hole"), "hole", tray.hole, &rack.holes)?;
        if trays[..index].iter().any(|other| other.hole == tray.hole) {
            let what = format!("hole {} already holds magnets", tray.hole);
            return Err(BinnacleError::new(field(index, "hole"), what));
        }
        if !rack.magnets.contains(&tray.magnet) {
            let what = format!("magnets {:?} do not fit there", tray.magnet);
            return Err(BinnacleError::new(field(index, "magnet"), what));
        }
        if !(1..=rack.magnets_each).contains(&tray.count) {
            let what = format!("{}; 1 to {} fit", tray.count, rack.magnets_each);
            return Err(BinnacleError::new(field(index, "count"), what));
        }
        if ![axis.red(true), axis.red(false)].contains(&tray.red) {
            let [one, other] = [axis.red(true), axis.red(false)];
            let what = format!("{} instead of {one} or {other}", tray.red);
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
    if !form.inventory.quadrantal.contains(&pair.size) {
        let what = format!("no pair {:?} is on board", pair.size);
        return Err(BinnacleError::new(field("size"), what));
    }
    if !iron
        .marks
        .iter()
        .any(|mark| nearly_equal(mark.mark_mm, pair.mark_mm))
    {
        let what = format!("the scale has no mark {} mm", pair.mark_mm);
        return Err(BinnacleError::new(field("mark_mm"), what));
    }
    slew_there(&field("slew_deg"), pair.slew_deg, &iron.slews_deg)
}

fn slew_there(field: &str, slew_deg: f64, slews_deg: &[f64]) -> Result<(), BinnacleError> {
    if slews_deg.iter().any(|slew| nearly_equal(*slew, slew_deg)) {
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
        .any(|(length, _)| nearly_equal(*length, bar.length_mm))
    {
        let what = format!("no pieces on board add up to {} mm", bar.length_mm);
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
        let what = format!("{}; 1 to {} fit", set.count, bucket.at_most);
        return Err(BinnacleError::new(field("count"), what));
    }
    if ![Red::Up, Red::Down].contains(&set.red) {
        let what = format!("{} instead of up or down", set.red);
        return Err(BinnacleError::new(field("red"), what));
    }
    Ok(())
}
