//! The written form of a binnacle on board (docs/binnacle.md).

use super::{Calibrated, Design, MagnetKind, Setting};
use serde::{Deserialize, Serialize};

/// A binnacle as it is written; [`Binnacle`] is one that was checked.
///
/// [`Binnacle`]: super::Binnacle
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BinnacleForm {
    /// Version of this form.
    pub version: u32,
    /// The maker's number of this one.
    pub serial: String,
    /// What kind it is.
    #[serde(rename = "type")]
    pub design: Design,
    /// All its correctors, in use and spare.
    pub aboard: Aboard,
    /// How they stand.
    pub setting: Setting,
    /// What was measured of them; it wins over the formulas.
    #[serde(default)]
    pub calibration: Vec<Calibrated>,
}

/// The correctors on board, those in use included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Aboard {
    /// Magnets by their kind.
    pub magnets: Vec<Lot>,
    /// Names of the sizes of which there is a pair.
    #[serde(default)]
    pub quadrantal: Vec<String>,
    /// Lengths of the Flinders bar's pieces, mm, each as often as there is one.
    #[serde(default)]
    pub flinders_pieces_mm: Vec<f64>,
}

/// Magnets of one kind on board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lot {
    /// Their kind.
    pub magnet: String,
    /// How many there are.
    pub count: u16,
    /// Their moment as it was tested, A·m²; the nominal one counts otherwise.
    #[serde(default)]
    pub tested_moment_am2: Option<f64>,
    /// Relative standard deviation of the tested moment; 0.02 where it is not said.
    #[serde(default)]
    pub tested_sd: Option<f64>,
}

/// Of a tested moment, relative.
const USUAL_TESTED_SD: f64 = 0.02;

/// A kind of magnets as it counts on board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    /// From end to end, mm.
    pub(crate) length_mm: f64,
    /// A·m².
    pub(crate) am2: f64,
    /// Relative.
    pub(crate) sd: f64,
}

impl BinnacleForm {
    /// The lot of a kind.
    pub fn lot(&self, magnet: &str) -> Option<&Lot> {
        self.aboard.magnets.iter().find(|lot| lot.magnet == magnet)
    }

    /// How many magnets of a kind there are on board.
    pub fn magnets_aboard(&self, magnet: &str) -> u16 {
        self.lot(magnet).map_or(0, |lot| lot.count)
    }

    /// The moment that counts: the tested one, else the nominal one.
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

    /// Every length that the bar can be made, with its pieces, shortest first; of
    /// equal lengths that with the fewest pieces.
    pub fn bar_lengths(&self) -> Vec<(f64, Vec<f64>)> {
        let longest_mm = self
            .design
            .flinders
            .as_ref()
            .map_or(0.0, |bar| bar.longest_mm);
        let pieces = &self.aboard.flinders_pieces_mm;
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
            let by_length = if super::same(a.0, b.0) {
                std::cmp::Ordering::Equal
            } else {
                by_length
            };
            by_length.then(a.1.len().cmp(&b.1.len()))
        });
        lengths.dedup_by(|later, earlier| super::same(later.0, earlier.0));
        lengths
    }
}
