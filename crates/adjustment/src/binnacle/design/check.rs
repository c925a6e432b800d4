//! Validation of a design; each error names its field.

use super::form::{DesignForm, Flinders, Heeling, Hole, MagnetKind, Quadrantal, Rack};
use crate::binnacle::error::BinnacleError;
use crate::binnacle::nearly_equal::nearly_equal;
use crate::binnacle::value_checks::{Checked, count, number, text_given, version};

/// Greatest distance of any part from the card, mm.
const FARTHEST_MM: f64 = 2_000.0;
/// Greatest relative tolerance of a corrector.
const GREATEST_TOLERANCE: f64 = 0.5;
/// Greatest number of kinds of magnets.
const MOST_KINDS: usize = 8;
/// Greatest number of trays of one axis, and of magnets in a tray or a bucket.
const MOST_TRAYS: u8 = 4;
const MOST_MAGNETS: u8 = 12;

pub(super) fn check(form: &DesignForm) -> Checked {
    version(form.version)?;
    for (name, text) in [
        ("maker", &form.maker),
        ("model", &form.model),
        ("provenance", &form.provenance),
    ] {
        text_given(name, text)?;
    }
    number("needle_moment_am2", form.needle_moment_am2, 0.0, 10.0)?;
    magnets(&form.magnets)?;
    for (name, axis) in [
        ("fore_and_aft", &form.fore_and_aft),
        ("athwartship", &form.athwartship),
    ] {
        rack(name, axis, form)?;
    }
    form.quadrantal.as_ref().map_or(Ok(()), quadrantal)?;
    form.flinders.as_ref().map_or(Ok(()), flinders)?;
    form.heeling.as_ref().map_or(Ok(()), |h| heeling(h, form))
}

fn magnets(kinds: &[MagnetKind]) -> Checked {
    count("magnets", kinds.len())?;
    if kinds.len() > MOST_KINDS {
        let what = format!("{} kinds; at most {MOST_KINDS} are accepted", kinds.len());
        return Err(BinnacleError::new("magnets", what));
    }
    for (index, kind) in kinds.iter().enumerate() {
        let field = |name: &str| format!("magnets[{index}].{name}");
        text_given(&field("name"), &kind.name)?;
        if kinds[..index].iter().any(|other| other.name == kind.name) {
            let what = format!("{:?} is listed twice", kind.name);
            return Err(BinnacleError::new(field("name"), what));
        }
        number(&field("length_mm"), kind.length_mm, 5.0, 1_000.0)?;
        number(&field("moment_am2"), kind.moment_am2, 1e-3, 100.0)?;
        let tolerance = kind.moment_tolerance;
        number(
            &field("moment_tolerance"),
            tolerance,
            0.0,
            GREATEST_TOLERANCE,
        )?;
    }
    Ok(())
}

fn rack(name: &str, rack: &Rack, form: &DesignForm) -> Checked {
    let field = |part: &str| format!("{name}.{part}");
    small_count(&field("at_once"), rack.at_once, MOST_TRAYS)?;
    small_count(&field("magnets_each"), rack.magnets_each, MOST_MAGNETS)?;
    number(&field("off_centre_mm"), rack.off_centre_mm, 0.0, 500.0)?;
    number(&field("position_sd_mm"), rack.position_sd_mm, 0.0, 50.0)?;
    count(&field("magnets"), rack.magnets.len())?;
    for (index, magnet) in rack.magnets.iter().enumerate() {
        let field = format!("{name}.magnets[{index}]");
        known_magnet(&field, magnet, form)?;
        if rack.magnets[..index].contains(magnet) {
            let what = format!("{magnet:?} is listed twice");
            return Err(BinnacleError::new(field, what));
        }
    }
    holes(&field("holes"), &rack.holes, 50.0)
}

fn known_magnet(field: &str, name: &str, form: &DesignForm) -> Checked {
    if form.magnet(name).is_some() {
        return Ok(());
    }
    let what = format!("there are no magnets {name:?} in `magnets`");
    Err(BinnacleError::new(field, what))
}

fn small_count(field: &str, count: u8, most: u8) -> Checked {
    number(field, f64::from(count), 1.0, f64::from(most))
}

/// Checks that holes are numbered from the bottom, each closer to the card than the one
/// below.
fn holes(field: &str, holes: &[Hole], nearest_mm: f64) -> Checked {
    count(field, holes.len())?;
    for (index, hole) in holes.iter().enumerate() {
        let path = |part: &str| format!("{field}[{index}].{part}");
        let depth = hole.below_card_mm;
        number(&path("below_card_mm"), depth, nearest_mm, FARTHEST_MM)?;
        if usize::from(hole.number) != index + 1 {
            let what = format!(
                "{} instead of {}: holes are numbered from the bottom, starting at 1",
                hole.number,
                index + 1
            );
            return Err(BinnacleError::new(path("number"), what));
        }
        if index > 0 && depth >= holes[index - 1].below_card_mm {
            let what = format!(
                "{depth} is not closer to the card than the hole below it, at {}",
                holes[index - 1].below_card_mm
            );
            return Err(BinnacleError::new(path("below_card_mm"), what));
        }
    }
    Ok(())
}

fn quadrantal(iron: &Quadrantal) -> Checked {
    count("quadrantal.sizes", iron.sizes.len())?;
    let mut widest_mm: f64 = 0.0;
    for (index, size) in iron.sizes.iter().enumerate() {
        let field = |part: &str| format!("quadrantal.sizes[{index}].{part}");
        text_given(&field("name"), &size.name)?;
        if iron.sizes[..index].iter().any(|s| s.name == size.name) {
            let what = format!("{:?} is listed twice", size.name);
            return Err(BinnacleError::new(field("name"), what));
        }
        number(&field("diameter_mm"), size.diameter_mm, 10.0, 600.0)?;
        number(&field("tolerance"), size.tolerance, 0.0, GREATEST_TOLERANCE)?;
        widest_mm = widest_mm.max(size.diameter_mm);
    }
    count("quadrantal.marks", iron.marks.len())?;
    for (index, mark) in iron.marks.iter().enumerate() {
        let field = |part: &str| format!("quadrantal.marks[{index}].{part}");
        number(&field("mark_mm"), mark.mark_mm, -FARTHEST_MM, FARTHEST_MM)?;
        // Closer than its diameter, a sphere is neither a dipole nor beside the bowl.
        number(&field("centre_mm"), mark.centre_mm, widest_mm, FARTHEST_MM)?;
        let earlier = &iron.marks[..index];
        if earlier
            .iter()
            .any(|m| nearly_equal(m.mark_mm, mark.mark_mm))
        {
            let what = format!("{} is listed twice", mark.mark_mm);
            return Err(BinnacleError::new(field("mark_mm"), what));
        }
        if earlier
            .iter()
            .any(|m| nearly_equal(m.centre_mm, mark.centre_mm))
        {
            let what = format!("{} is another mark's position", mark.centre_mm);
            return Err(BinnacleError::new(field("centre_mm"), what));
        }
    }
    slews("quadrantal.slews_deg", &iron.slews_deg)
}

fn slews(field: &str, slews_deg: &[f64]) -> Checked {
    count(field, slews_deg.len())?;
    for (index, slew) in slews_deg.iter().enumerate() {
        let path = format!("{field}[{index}]");
        number(&path, *slew, -90.0, 90.0)?;
        if slews_deg[..index].iter().any(|s| nearly_equal(*s, *slew)) {
            return Err(BinnacleError::new(path, format!("{slew} is listed twice")));
        }
    }
    Ok(())
}

fn flinders(bar: &Flinders) -> Checked {
    number("flinders.diameter_mm", bar.diameter_mm, 10.0, 200.0)?;
    number(
        "flinders.axis_mm",
        bar.axis_mm,
        bar.diameter_mm,
        FARTHEST_MM,
    )?;
    number(
        "flinders.longest_mm",
        bar.longest_mm,
        bar.diameter_mm,
        FARTHEST_MM,
    )?;
    count("flinders.sides", bar.sides.len())?;
    if bar.sides.len() > 1 && bar.sides[1..].contains(&bar.sides[0]) {
        let what = format!("{} is listed twice", bar.sides[0]);
        return Err(BinnacleError::new("flinders.sides", what));
    }
    number("flinders.tolerance", bar.tolerance, 0.0, GREATEST_TOLERANCE)?;
    slews("flinders.slews_deg", &bar.slews_deg)
}

fn heeling(bucket: &Heeling, form: &DesignForm) -> Checked {
    known_magnet("heeling.magnet", &bucket.magnet, form)?;
    small_count("heeling.at_most", bucket.at_most, MOST_MAGNETS)?;
    let length_mm = form
        .magnet(&bucket.magnet)
        .map_or(0.0, |kind| kind.length_mm);
    holes(
        "heeling.positions",
        &bucket.positions,
        length_mm / 2.0 + 20.0,
    )
}
