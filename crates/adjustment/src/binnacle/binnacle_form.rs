//! Written form of a binnacle on board (docs/binnacle.md).

use super::axis::Axis;
use super::calibration::Calibrated;
use super::design::{Design, MagnetKind};
use super::inventory::{Inventory, Lot};
use super::nearly_equal::nearly_equal;
use super::setting::Setting;
use serde::{Deserialize, Serialize};

/// Written form of a binnacle on board; docs/binnacle.md explains every field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = Binnacle))]
#[serde(deny_unknown_fields)]
pub struct BinnacleForm {
    /// Version of the form: 1.
    pub version: u32,
    /// Maker's serial number.
    pub serial: String,
    /// Design of its kind.
    #[serde(rename = "type")]
    #[cfg_attr(feature = "openapi", schema(value_type = crate::binnacle::DesignForm))]
    pub design: Design,
    /// All correctors on board, in use and spare.
    #[serde(rename = "aboard")]
    pub inventory: Inventory,
    /// Setting of the correctors.
    pub setting: Setting,
    /// Measured effects of the correctors, which take precedence over the formulas.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(value_type = Vec<Object>))]
    pub calibration: Vec<Calibrated>,
}

/// Default relative standard deviation of a tested moment.
const USUAL_TESTED_SD: f64 = 0.02;

/// Effective moment of a kind of magnets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    /// From end to end, mm.
    pub(crate) length_mm: f64,
    /// Moment, A·m².
    pub(crate) am2: f64,
    /// Relative standard deviation of the moment.
    pub(crate) sd: f64,
}

impl BinnacleForm {
    /// Finds the lot of a kind.
    pub fn lot(&self, magnet: &str) -> Option<&Lot> {
        self.inventory
            .magnets
            .iter()
            .find(|lot| lot.magnet == magnet)
    }

    /// Counts the magnets of a kind on board.
    pub fn magnet_count(&self, magnet: &str) -> u16 {
        self.lot(magnet).map_or(0, |lot| lot.count)
    }

    /// Returns the tested moment, else the nominal one.
    pub(crate) fn moment(&self, kind: &MagnetKind) -> Moment {
        let tested = self.lot(&kind.name);
        let tested = tested.and_then(|lot| Some((lot.tested_moment_am2?, lot.tested_sd)));
        let (am2, sd) = tested.map_or((kind.moment_am2, kind.moment_tolerance), |(am2, sd)| {
            (am2, sd.unwrap_or(USUAL_TESTED_SD))
        });
        Moment {
            length_mm: kind.length_mm,
            am2,
            sd,
        }
    }

    /// Lists every possible length of the bar with its pieces, shortest first; of equal
    /// lengths, the one with the fewest pieces.
    pub fn bar_lengths(&self) -> Vec<(f64, Vec<f64>)> {
        let longest_mm = self
            .design
            .flinders
            .as_ref()
            .map_or(0.0, |bar| bar.longest_mm);
        let pieces = &self.inventory.flinders_pieces_mm;
        let mut lengths: Vec<(f64, Vec<f64>)> = (1_u32..1 << pieces.len())
            .map(|chosen| {
                let held = |index: &usize| chosen & (1 << index) != 0;
                let mut held: Vec<f64> =
                    (0..pieces.len()).filter(held).map(|i| pieces[i]).collect();
                // The longest piece stands on top (Pub. 226, art. 607).
                held.sort_by(|a, b| b.total_cmp(a));
                (held.iter().sum(), held)
            })
            .filter(|(length, _)| *length <= longest_mm + 1e-6)
            .collect();
        lengths.sort_by(|a, b| {
            let by_length = a.0.total_cmp(&b.0);
            let by_length = if nearly_equal(a.0, b.0) {
                std::cmp::Ordering::Equal
            } else {
                by_length
            };
            by_length.then(a.1.len().cmp(&b.1.len()))
        });
        lengths.dedup_by(|later, earlier| nearly_equal(later.0, earlier.0));
        lengths
    }
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
            } if size == name && nearly_equal(*mark_mm, at_mm) => {
                Some(Measured { value: *q, sd: *sd })
            }
            _ => None,
        })
    }

    pub(crate) fn calibrated_bar(&self, of_mm: f64) -> Option<Measured> {
        self.calibration.iter().find_map(|entry| match entry {
            Calibrated::Flinders { length_mm, c, sd } if nearly_equal(*length_mm, of_mm) => {
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
