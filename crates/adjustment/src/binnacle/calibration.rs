//! What was measured of a binnacle's correctors; it wins over the formulas.

use super::axis::Axis;
use super::nearly_equal::nearly_equal;
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
            ) => size == s && nearly_equal(*mark_mm, *m),
            (Flinders { length_mm, .. }, Flinders { length_mm: l, .. }) => {
                nearly_equal(*length_mm, *l)
            }
            (Heeling { position, .. }, Heeling { position: p, .. }) => position == p,
            _ => false,
        }
    }
}
