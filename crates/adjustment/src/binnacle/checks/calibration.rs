//! Validation of measured effects.

use crate::binnacle::binnacle_form::BinnacleForm;
use crate::binnacle::calibration::Calibrated;
use crate::binnacle::error::BinnacleError;
use crate::binnacle::nearly_equal::nearly_equal;
use crate::binnacle::value_checks::number;

pub(super) fn check(form: &BinnacleForm) -> Result<(), BinnacleError> {
    for (index, entry) in form.calibration.iter().enumerate() {
        let field = |part: &str| format!("calibration[{index}].{part}");
        let absent = |part: &str, what: String| Err(BinnacleError::new(field(part), what));
        match entry {
            Calibrated::Magnet {
                axis,
                magnet,
                hole,
                field_nt,
                sd,
            } => {
                let rack = form.design.rack(*axis);
                if rack.hole(*hole).is_none() {
                    return absent("hole", format!("there is no hole {hole}"));
                }
                if !rack.magnets.contains(magnet) {
                    return absent("magnet", format!("magnets {magnet:?} do not fit there"));
                }
                number(&field("field_nt"), *field_nt, 0.0, 200_000.0)?;
                number(&field("sd"), *sd, 0.0, 0.5)?;
            }
            Calibrated::Quadrantal {
                size,
                mark_mm,
                q,
                sd,
            } => {
                let iron = form.design.quadrantal.as_ref();
                if !iron.is_some_and(|iron| iron.sizes.iter().any(|s| s.name == *size)) {
                    return absent("size", format!("the type has no {size:?}"));
                }
                if !iron.is_some_and(|iron| {
                    iron.marks.iter().any(|m| nearly_equal(m.mark_mm, *mark_mm))
                }) {
                    return absent("mark_mm", format!("the scale has no mark {mark_mm} mm"));
                }
                number(&field("q"), *q, 0.0, 0.2)?;
                number(&field("sd"), *sd, 0.0, 0.5)?;
            }
            Calibrated::Flinders { length_mm, c, sd } => {
                if form.design.flinders.is_none() {
                    return absent("length_mm", "the type has no Flinders bar".to_owned());
                }
                number(&field("length_mm"), *length_mm, 5.0, 2_000.0)?;
                number(&field("c"), *c, 0.0, 0.5)?;
                number(&field("sd"), *sd, 0.0, 0.5)?;
            }
            Calibrated::Heeling { position, field_nt } => {
                let bucket = form.design.heeling.as_ref();
                if !bucket.is_some_and(|b| b.positions.iter().any(|p| p.number == *position)) {
                    return absent("position", format!("there is no position {position}"));
                }
                number(&field("field_nt"), *field_nt, 0.0, 200_000.0)?;
            }
        }
        let twice = form.calibration[..index]
            .iter()
            .any(|other| other.same_place(entry));
        if twice {
            let what = "the same corrector at the same position is listed twice";
            return Err(BinnacleError::new(format!("calibration[{index}]"), what));
        }
    }
    Ok(())
}
