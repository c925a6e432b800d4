//! Why no model came out of a set of observations.

use serde::{Deserialize, Serialize};

/// A refusal to fit; each says what is missing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(tag = "reason", rename_all = "snake_case")]
pub enum FitError {
    /// No reading has a heading to hold the compass against.
    #[error("no gyro, satellite or other true heading in any of {readings} readings")]
    NoReference {
        /// How many readings there are.
        readings: u64,
    },
    /// Every observation has the weight 0.
    #[error("the weight is 0 in all of {samples} samples")]
    NoWeight {
        /// How many there are.
        samples: u64,
    },
    /// Too few observations with a reference, whatever their headings.
    #[error("{found} usable samples; at least {needed} are needed")]
    TooFewSamples {
        /// How many there are.
        found: u64,
        /// How many there must be.
        needed: u64,
    },
    /// The observations lie on too few headings.
    #[error(
        "headings in {found} of 24 sectors of 15 degrees, the widest gap {widest_gap_deg:.0} degrees; \
         at least {needed} sectors are needed and no gap over {allowed_gap_deg:.0} degrees; \
         missing: {}", ranges(.missing_deg)
    )]
    TooFewHeadings {
        /// Sectors of 15° with at least one observation.
        found: u32,
        /// How many there must be.
        needed: u32,
        /// The widest range of headings without an observation.
        widest_gap_deg: f64,
        /// The widest such range that is allowed.
        allowed_gap_deg: f64,
        /// The headings without an observation: whole sectors of 15°, each range by
        /// its first degree and the one after its last, beyond 360 through north.
        #[serde(default)]
        missing_deg: Vec<(u32, u32)>,
    },
    /// The earth's horizontal field is too weak for a compass.
    #[error(
        "horizontal field of at most {strongest_nt:.0} nT; a compass needs at least {needed_nt:.0} nT"
    )]
    FieldTooWeak {
        /// The strongest horizontal field among the observations.
        strongest_nt: f64,
        /// What there must be.
        needed_nt: f64,
    },
    /// The fitted magnetism leaves no directive force on some heading, so that
    /// one compass heading may belong to several courses.
    #[error("the fitted magnetism makes headings ambiguous at a horizontal field of {h_nt:.0} nT")]
    AmbiguousHeadings {
        /// The horizontal field at which it does.
        h_nt: f64,
    },
    /// All observations have the same dip, so that the paper's equations have
    /// no unique solution: bx and χ13 Z, by and χ23 Z are known as sums only.
    #[error(
        "all samples lie at one magnetic latitude: bx and chi13, by and chi23 cannot be told apart"
    )]
    OneMagneticLatitude,
    /// Gyro and satellite compass differ throughout by more than any alignment
    /// explains, and headings cannot tell which of them is wrong.
    #[error(
        "gyro and satellite compass differ by {offset_deg:.1} degrees throughout, more than the \
         {allowed_deg:.0} degrees that any alignment explains: one of them is wrong"
    )]
    ReferencesDisagree {
        /// Gyro less satellite compass, degrees.
        offset_deg: f64,
        /// How far they may differ.
        allowed_deg: f64,
    },
    /// The only reference stood still while the ship turned.
    #[error(
        "the reference stands still in {readings} readings while the compass turns: it is stuck, \
         or the wrong source was taken for it"
    )]
    ReferenceStuck {
        /// In how many readings it did.
        readings: u64,
    },
    /// What the best ship leaves over is more than instruments do.
    #[error(
        "residuals of {residual_deg:.1} degrees, where no instruments leave more than \
         {allowed_deg:.0}: no ship explains these; check the sign of the variation, which column \
         is which, and whether the compass or the reference stood still for days"
    )]
    Contradictory {
        /// Robust standard deviation of the residuals, degrees.
        residual_deg: f64,
        /// How large it may be.
        allowed_deg: f64,
    },
    /// The iteration did not settle.
    #[error(
        "the fit did not settle: the samples contradict each other or any ship; check the sign of \
         the variation, which column is which, and whether the compass or the reference stood still \
         for days"
    )]
    NotConverged,
}

/// Ranges of headings for people.
fn ranges(missing: &[(u32, u32)]) -> String {
    let range = |&(from, to): &(u32, u32)| format!("{from:03}-{:03}", (to - 1) % 360 + 1);
    let ranges: Vec<String> = missing.iter().map(range).collect();
    ranges.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_missing_headings_run_through_north() {
        let missing = [(90, 135), (180, 195), (345, 390)];
        assert_eq!(ranges(&missing), "090-135, 180-195, 345-030");
        assert_eq!(ranges(&[(0, 360)]), "000-360");
    }
}
