//! Measured effects of a binnacle's correctors.

use super::axis::Axis;
use super::nearly_equal::nearly_equal;
use serde::{Deserialize, Serialize};

/// Measured effect of one corrector at one position; it takes precedence over the formulas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "corrector", rename_all = "snake_case", deny_unknown_fields)]
pub enum Calibrated {
    /// One magnet in a hole.
    Magnet {
        /// Axis of the magnet.
        axis: Axis,
        /// Kind of the magnet.
        magnet: String,
        /// Number of the hole.
        hole: u16,
        /// Magnitude of its field at the card, nT.
        field_nt: f64,
        /// Relative standard deviation of the field.
        #[serde(default = "usual_sd")]
        sd: f64,
    },
    /// A pair at a mark.
    Quadrantal {
        /// Name of the size.
        size: String,
        /// Position on the scale, mm.
        mark_mm: f64,
        /// Effect q of the pair, a third of its reduction of λD (docs/science.md, eq. 20).
        q: f64,
        /// Relative standard deviation of q.
        #[serde(default = "usual_sd")]
        sd: f64,
    },
    /// A Flinders bar of a length.
    Flinders {
        /// Total length of its pieces, mm.
        length_mm: f64,
        /// χ13 of the bar in its forward position.
        c: f64,
        /// Relative standard deviation of χ13.
        #[serde(default = "usual_sd")]
        sd: f64,
    },
    /// One magnet in the bucket.
    Heeling {
        /// Number of the position.
        position: u16,
        /// Magnitude of its field at the card, nT.
        field_nt: f64,
    },
}

fn usual_sd() -> f64 {
    0.02
}

impl Calibrated {
    /// Returns true when both are for one corrector at one position.
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
