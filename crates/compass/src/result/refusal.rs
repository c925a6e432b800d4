//! Refusal of a fit.

use crate::model::VariationMistake;
use serde::{Deserialize, Serialize};

/// Reason for a fit without a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = Refusal))]
#[serde(tag = "reason", rename_all = "snake_case")]
pub enum FitError {
    /// No reading has a reference heading.
    #[error("no gyro, satellite or other true heading in any of {readings} readings")]
    NoReference {
        /// Number of readings.
        readings: u64,
    },
    /// The vessel has no gyro or satellite compass, and too few samples whose course over ground
    /// shows the heading.
    #[error(
        "no gyro, satellite or other true heading, and the course over ground shows the heading \
         in {found} of {readings} readings, at least {needed} are needed: {too_slow} are below \
         {least_sog_kn:.0} knots and {turning} in a turn or just after one"
    )]
    NoSteadyCourse {
        /// Number of readings.
        readings: u64,
        /// Number of usable readings.
        found: u64,
        /// Least number of usable readings.
        needed: u64,
        /// Number of readings at too low a speed.
        too_slow: u64,
        /// Number of readings in a turn or just after one.
        turning: u64,
        /// Least usable speed over ground, knots.
        least_sog_kn: f64,
    },
    /// Every observation has the weight 0; only in fits of a file.
    #[error("the weight is 0 in all of {samples} samples")]
    NoWeight {
        /// Number of samples.
        samples: u64,
    },
    /// Too few observations with a reference, on any headings.
    #[error("{found} usable samples; at least {needed} are needed")]
    TooFewSamples {
        /// Number of usable samples.
        found: u64,
        /// Least number of samples.
        needed: u64,
    },
    /// The samples lie on too few headings.
    #[error(
        "headings in {found} of 24 sectors of 15 degrees, the widest gap {widest_gap_deg:.0} \
         degrees; at least {needed} sectors are needed and no gap over {allowed_gap_deg:.0} \
         degrees; missing: {}", ranges(.missing_deg)
    )]
    TooFewHeadings {
        /// Number of 15° sectors with at least one observation.
        found: u32,
        /// Least number of sectors.
        needed: u32,
        /// Widest gap of headings without an observation, degrees.
        widest_gap_deg: f64,
        /// Widest allowed gap, degrees.
        allowed_gap_deg: f64,
        /// Headings without an observation: whole sectors of 15°, each range by its first
        /// degree and the one after its last, beyond 360 through north.
        #[serde(default)]
        #[cfg_attr(feature = "openapi", schema(required, value_type = Vec<[u32; 2]>))]
        missing_deg: Vec<(u32, u32)>,
    },
    /// The earth's horizontal field is too weak for a compass in all samples.
    #[error(
        "horizontal field of at most {strongest_nt:.0} nT; a compass needs at least \
         {needed_nt:.0} nT"
    )]
    FieldTooWeak {
        /// Strongest horizontal field among the observations, nT.
        strongest_nt: f64,
        /// Least horizontal field for a compass, nT.
        needed_nt: f64,
    },
    /// The fitted magnetism leaves no directive force on some heading, so a compass heading
    /// may stand for several magnetic headings.
    #[error("the fitted magnetism makes headings ambiguous at a horizontal field of {h_nt:.0} nT")]
    AmbiguousHeadings {
        /// Horizontal field of the ambiguity, nT.
        h_nt: f64,
    },
    /// All observations have the same dip: only the sums bx + χ13 Z and by + χ23 Z are
    /// determined, and the paper's equations have no unique solution. Only in fits without a
    /// prior.
    #[error(
        "all samples lie at one magnetic latitude: bx and chi13, by and chi23 cannot be separated"
    )]
    OneMagneticLatitude,
    /// Gyro and satellite compass differ throughout by more than any misalignment, and
    /// headings cannot show which is wrong.
    #[error(
        "gyro and satellite compass differ by {offset_deg:.1} degrees throughout, more than \
         any misalignment ({allowed_deg:.0} degrees): one of them is wrong"
    )]
    ReferencesDisagree {
        /// Gyro less satellite compass, degrees.
        offset_deg: f64,
        /// Greatest allowed difference, degrees.
        allowed_deg: f64,
    },
    /// The only reference was stuck while the ship turned.
    #[error(
        "the reference does not move in {readings} readings while the compass turns: it is stuck, \
         or the wrong source is configured"
    )]
    ReferenceStuck {
        /// Number of readings with a stuck reference.
        readings: u64,
    },
    /// The reference is made from the compass's own reading: it agrees with the compass however
    /// wrong that is.
    #[error(
        "the reference heading is the compass's own: their difference scatters by \
         {scatter_deg:.2} degrees about a smooth curve in {samples} samples, where independent \
         instruments with these digits leave at least {least_deg:.2}; check which source is \
         configured as the reference"
    )]
    ReferenceIsCompass {
        /// Number of samples with the reference.
        samples: u64,
        /// Scatter of reference less compass about a smooth curve, degrees.
        scatter_deg: f64,
        /// Least scatter of independent instruments with the same digits, degrees.
        least_deg: f64,
    },
    /// The reference is no true heading: its error is a multiple of the variation.
    #[error(
        "the reference is no true heading: {mistake} (scatter about the best ship \
         {explained_deg:.1} degrees so, {residual_deg:.1} as it stands)"
    )]
    VariationMistaken {
        /// Mistake that explains the samples.
        mistake: VariationMistake,
        /// Robust standard deviation about the best ship as the reference stands, degrees.
        residual_deg: f64,
        /// Such a standard deviation where the mistake is undone, degrees.
        explained_deg: f64,
    },
    /// The fit gave no weight to most of the samples, so that the model is that of a minority.
    #[error(
        "only {used} of {found} samples agree with any one ship: the others contradict them; \
         check whether the compass was moved or the reference was wrong, and fit the times \
         before and after by themselves"
    )]
    FewSamplesUsed {
        /// Number of samples with weight in the fit.
        used: u64,
        /// Number of samples with a reference.
        found: u64,
    },
    /// The model predicts its own samples worse than a compass may deviate.
    #[error(
        "the model leaves residuals of {residual_deg:.1} degrees in its own samples, more than \
         the {allowed_deg:.0} that a compass may deviate: it does not explain them; check \
         whether the compass, its correctors or the reference were changed in between"
    )]
    ModelDoesNotExplain {
        /// Robust standard deviation of the residuals about zero, degrees.
        residual_deg: f64,
        /// Greatest allowed value, degrees.
        allowed_deg: f64,
    },
    /// The residuals of the best fit exceed any instrument error: a variation of the wrong
    /// sign, exchanged columns, or a stuck reference.
    #[error(
        "residuals of {residual_deg:.1} degrees, more than any instruments' {allowed_deg:.0}: no \
         ship explains these; check the sign of the variation, the order of the columns, and \
         whether the compass or the reference was stuck for days"
    )]
    Contradictory {
        /// Robust standard deviation of the residuals, degrees.
        residual_deg: f64,
        /// Greatest allowed value, degrees.
        allowed_deg: f64,
    },
    /// The iteration did not converge: the samples contradict each other, or any ship.
    #[error(
        "the fit did not converge: the samples contradict each other or any ship; check the sign \
         of the variation, the order of the columns, and whether the compass or the reference was \
         stuck for days"
    )]
    NotConverged,
}

/// Formats ranges of headings.
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
