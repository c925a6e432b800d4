//! What was measured of a binnacle's correctors; it wins over the formulas.

use super::check::number;
use super::{Axis, BinnacleError, BinnacleForm, same};
use serde::{Deserialize, Serialize};

/// The effect of one corrector at one position, as it was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "corrector", rename_all = "snake_case", deny_unknown_fields)]
pub enum Calibrated {
    /// One magnet in a hole.
    Magnet {
        /// Which way it lies.
        axis: Axis,
        /// Its kind.
        magnet: String,
        /// The hole's number.
        hole: u16,
        /// Size of its field at the card, nT.
        field_nt: f64,
        /// Relative standard deviation of that.
        #[serde(default = "usual_sd")]
        sd: f64,
    },
    /// A pair at a mark: q of docs/science.md, eq. 20.
    Quadrantal {
        /// Name of the size.
        size: String,
        /// Position on the scale, mm.
        mark_mm: f64,
        /// A third of what the pair takes off λD.
        q: f64,
        /// Relative standard deviation of that.
        #[serde(default = "usual_sd")]
        sd: f64,
    },
    /// A bar of a length: its χ13 when it stands forward.
    Flinders {
        /// Length of its pieces, mm.
        length_mm: f64,
        /// χ13.
        c: f64,
        /// Relative standard deviation of that.
        #[serde(default = "usual_sd")]
        sd: f64,
    },
    /// One magnet in the bucket.
    Heeling {
        /// The position's number.
        position: u16,
        /// Size of its field at the card, nT.
        field_nt: f64,
    },
}

fn usual_sd() -> f64 {
    0.02
}

/// A measured effect and its relative standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measured {
    pub(crate) value: f64,
    pub(crate) sd: f64,
}

impl BinnacleForm {
    pub(crate) fn calibrated_magnet(&self, of: Axis, kind: &str, number: u16) -> Option<Measured> {
        self.calibration.iter().find_map(|entry| match entry {
            Calibrated::Magnet {
                axis,
                magnet,
                hole,
                field_nt,
                sd,
            } if *axis == of && magnet == kind && *hole == number => Some(Measured {
                value: *field_nt,
                sd: *sd,
            }),
            _ => None,
        })
    }

    pub(crate) fn calibrated_pair(&self, name: &str, at_mm: f64) -> Option<Measured> {
        self.calibration.iter().find_map(|entry| match entry {
            Calibrated::Quadrantal {
                size,
                mark_mm,
                q,
                sd,
            } if size == name && same(*mark_mm, at_mm) => Some(Measured { value: *q, sd: *sd }),
            _ => None,
        })
    }

    pub(crate) fn calibrated_bar(&self, of_mm: f64) -> Option<Measured> {
        self.calibration.iter().find_map(|entry| match entry {
            Calibrated::Flinders { length_mm, c, sd } if same(*length_mm, of_mm) => {
                Some(Measured { value: *c, sd: *sd })
            }
            _ => None,
        })
    }

    pub(crate) fn calibrated_heeling(&self, number: u16) -> Option<f64> {
        self.calibration.iter().find_map(|entry| match entry {
            Calibrated::Heeling { position, field_nt } if *position == number => Some(*field_nt),
            _ => None,
        })
    }
}

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
                    return absent("magnet", format!("no magnets {magnet:?} fit there"));
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
                if !iron.is_some_and(|iron| iron.marks.iter().any(|m| same(m.mark_mm, *mark_mm))) {
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
            let what = "the same corrector at the same position stands there twice";
            return Err(BinnacleError::new(format!("calibration[{index}]"), what));
        }
    }
    Ok(())
}

impl Calibrated {
    /// Whether both are of one corrector at one position.
    pub(crate) fn same_place(&self, other: &Calibrated) -> bool {
        use Calibrated::{Flinders, Heeling, Magnet, Quadrantal};
        match (self, other) {
            (
                Magnet {
                    axis, magnet, hole, ..
                },
                Magnet {
                    axis: a,
                    magnet: m,
                    hole: h,
                    ..
                },
            ) => (axis, magnet, hole) == (a, m, h),
            (
                Quadrantal { size, mark_mm, .. },
                Quadrantal {
                    size: s,
                    mark_mm: m,
                    ..
                },
            ) => size == s && same(*mark_mm, *m),
            (Flinders { length_mm, .. }, Flinders { length_mm: l, .. }) => same(*length_mm, *l),
            (Heeling { position, .. }, Heeling { position: p, .. }) => position == p,
            _ => false,
        }
    }
}
