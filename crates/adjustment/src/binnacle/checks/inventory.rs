//! Validation of the correctors on board.

use crate::binnacle::binnacle_form::BinnacleForm;
use crate::binnacle::error::BinnacleError;
use crate::binnacle::value_checks::{count, number, text_given, version};

/// Greatest number of settings of spheres and bar.
const MOST_CHOICES: usize = 50_000;
/// Least and greatest tested moment, as a share of the nominal one.
const WEAKEST: f64 = 0.1;
const STRONGEST: f64 = 2.0;
/// Greatest number of pieces; the search goes through 2¹⁰ combinations.
const MOST_PIECES: usize = 10;

pub(super) fn check(form: &BinnacleForm) -> Result<(), BinnacleError> {
    version(form.version)?;
    text_given("serial", &form.serial)?;
    count("aboard.magnets", form.inventory.magnets.len())?;
    for (index, lot) in form.inventory.magnets.iter().enumerate() {
        let field = |part: &str| format!("aboard.magnets[{index}].{part}");
        if form.design.magnet(&lot.magnet).is_none() {
            let what = format!("the type has no magnets {:?}", lot.magnet);
            return Err(BinnacleError::new(field("magnet"), what));
        }
        let earlier = &form.inventory.magnets[..index];
        if earlier.iter().any(|other| other.magnet == lot.magnet) {
            let what = format!("{:?} is listed twice", lot.magnet);
            return Err(BinnacleError::new(field("magnet"), what));
        }
        if let Some(moment) = lot.tested_moment_am2 {
            number(&field("tested_moment_am2"), moment, 1e-3, 100.0)?;
        }
        if let Some(sd) = lot.tested_sd {
            number(&field("tested_sd"), sd, 0.0, 0.5)?;
        }
    }
    quadrantal(form)?;
    pieces(form)?;
    choices(form)
}

/// Checks that tested moments are plausible. A magnet loses strength over the years and
/// holds little more than the maker's nominal moment, so anything else is a misreading or a
/// typing error.
pub(crate) fn check_tested_moments(form: &BinnacleForm) -> Result<(), BinnacleError> {
    for (index, lot) in form.inventory.magnets.iter().enumerate() {
        let nominal = form.design.magnet(&lot.magnet).map(|kind| kind.moment_am2);
        let Some((moment, nominal)) = lot.tested_moment_am2.zip(nominal) else {
            continue;
        };
        let (least, most) = (WEAKEST * nominal, STRONGEST * nominal);
        if !(least..=most).contains(&moment) {
            let what = format!(
                "{moment} A·m² is implausible for a magnet of {nominal} A·m²: accepted are \
                 {least:.3} to {most:.3}"
            );
            let field = format!("aboard.magnets[{index}].tested_moment_am2");
            return Err(BinnacleError::new(field, what));
        }
    }
    Ok(())
}

/// Limits the number of settings, so that a search ends in bounded memory.
fn choices(form: &BinnacleForm) -> Result<(), BinnacleError> {
    let pairs = form.design.quadrantal.as_ref().map_or(0, |iron| {
        form.inventory.quadrantal.len() * iron.marks.len() * iron.slews_deg.len()
    });
    let bars = form.design.flinders.as_ref().map_or(0, |bar| {
        form.bar_lengths().len() * bar.sides.len() * bar.slews_deg.len()
    });
    let all = (pairs + 1) * (bars + 1);
    if all > MOST_CHOICES {
        let what = format!("{all} choices of soft iron; at most {MOST_CHOICES} are accepted");
        return Err(BinnacleError::new("aboard", what));
    }
    Ok(())
}

fn quadrantal(form: &BinnacleForm) -> Result<(), BinnacleError> {
    let sizes = form.design.quadrantal.as_ref().map(|iron| &iron.sizes);
    for (index, name) in form.inventory.quadrantal.iter().enumerate() {
        if !sizes.is_some_and(|sizes| sizes.iter().any(|size| size.name == *name)) {
            let what = format!("the type has no quadrantal correctors {name:?}");
            return Err(BinnacleError::new(
                format!("aboard.quadrantal[{index}]"),
                what,
            ));
        }
    }
    Ok(())
}

fn pieces(form: &BinnacleForm) -> Result<(), BinnacleError> {
    let pieces = &form.inventory.flinders_pieces_mm;
    let field = "aboard.flinders_pieces_mm";
    if pieces.len() > MOST_PIECES {
        let what = format!(
            "{} pieces; at most {MOST_PIECES} are accepted",
            pieces.len()
        );
        return Err(BinnacleError::new(field, what));
    }
    let Some(bar) = &form.design.flinders else {
        if pieces.is_empty() {
            return Ok(());
        }
        return Err(BinnacleError::new(field, "the type has no Flinders bar"));
    };
    for (index, length) in pieces.iter().enumerate() {
        number(&format!("{field}[{index}]"), *length, 5.0, bar.longest_mm)?;
    }
    Ok(())
}
