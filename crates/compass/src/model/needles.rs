//! Induction of a compass's needles in its quadrantal correctors.

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
