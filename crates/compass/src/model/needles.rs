//! Induction of a compass's needles in its quadrantal correctors.

use super::Parameters;
use crate::ship::{EarthField, PARAMETERS};
use serde::{Deserialize, Serialize};

/// Part of D and E that the compass's needles induce in its quadrantal correctors. The
/// needles' field is the same everywhere, so this part grows as 1/H (docs/science.md,
/// eq. 18), while the rest of D and E is the same in all waters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct NeedleInduction {
    /// The needles' part of D times H, nT: (N11 − N22)/2λ.
    pub d_nt: f64,
    /// The needles' part of E times H, nT: N12/λ.
    pub e_nt: f64,
    /// Horizontal field at which the model's parameters contain this part, nT: the harmonic
    /// mean over the samples.
    pub reference_h_nt: f64,
    /// Relative standard deviation of both parts.
    pub relative_sd: f64,
}

impl NeedleInduction {
    /// Adds the change of this part from the reference's horizontal field to another.
    pub(crate) fn adapt(&self, parameters: &Parameters, earth: EarthField) -> Parameters {
        let [.., d, b, e] = self.change(earth);
        Parameters {
            chi11_minus_chi22: parameters.chi11_minus_chi22 + d,
            chi12: parameters.chi12 + b,
            chi21: parameters.chi21 + e,
            ..*parameters
        }
    }

    /// Returns the change of each parameter from the reference's horizontal field.
    pub(crate) fn change(&self, earth: EarthField) -> [f64; PARAMETERS] {
        let by_field = 1.0 / earth.h_nt - 1.0 / self.reference_h_nt;
        let (d, e) = (self.d_nt * by_field, self.e_nt * by_field);
        [0.0, 0.0, 0.0, 0.0, 2.0 * d, e, e]
    }
}
