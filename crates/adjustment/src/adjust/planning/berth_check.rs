//! Check of the berth, and visibility of the coefficients on its heading.

use crate::adjust::inputs::Adjustment;
use crate::adjust::state::MagneticState;
use crate::berth::{Consistency, Estimated, USUAL_LAMBDA, Verdict};
use serde::{Deserialize, Serialize};

/// Share of a coefficient below which it is hardly visible on a heading.
const HARDLY: f64 = 0.25;

/// Check of the berth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BerthCheck {
    /// λ, determined equally well on every heading.
    pub lambda: Estimated,
    /// Relative standard error of λ, including the magnetometer's scale.
    pub lambda_sd: f64,
    /// Agreement of the field's direction with the model.
    pub consistency: Consistency,
    /// Visible part of each coefficient's deviation on this heading: precision of a step's
    /// check on the spot.
    pub seen: HeadingVisibility,
}

/// Visible parts of the coefficients' deviations on a heading, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeadingVisibility {
    /// Visible part of B: fore-and-aft magnets and the Flinders bar.
    pub b: f64,
    /// Visible part of C: athwartship magnets.
    pub c: f64,
    /// Visible part of D: spheres.
    pub d: f64,
    /// Visible part of E: slewed spheres.
    pub e: f64,
}

impl BerthCheck {
    pub(crate) fn new(adjustment: &Adjustment<'_>, state: &MagneticState<'_>) -> BerthCheck {
        let (sin, cos) = adjustment.reading.magnetic().radians().sin_cos();
        BerthCheck {
            lambda: state.estimate.lambda,
            lambda_sd: state.lambda_sd_share(),
            consistency: state.estimate.consistency,
            seen: HeadingVisibility {
                b: sin.abs(),
                c: cos.abs(),
                d: (2.0 * sin * cos).abs(),
                e: (cos * cos - sin * sin).abs(),
            },
        }
    }

    /// Lists notes for the adjuster.
    pub(crate) fn notes(&self) -> Vec<String> {
        let mut words = Vec::new();
        if self.consistency.verdict == Verdict::Loose {
            words.push(format!(
                "the berth has verified little: {}",
                self.consistency
            ));
        }
        let lambda = self.lambda.value;
        if !USUAL_LAMBDA.contains(&lambda) {
            let (least, greatest) = (USUAL_LAMBDA.start(), USUAL_LAMBDA.end());
            words.push(format!(
                "lambda is {lambda:.2}, while {least} to {greatest} is usual: the magnetometer may \
                 have a wrong scale or may not have been where the card is, and the whole plan \
                 errs in proportion; read again before anything is moved"
            ));
        }
        let HeadingVisibility { b, c, d, e } = self.seen;
        for (seen, what) in [
            (b, "fore-and-aft magnets and the Flinders bar"),
            (c, "athwartship magnets"),
            (d, "spheres"),
            (e, "slewing of spheres"),
        ] {
            if seen < HARDLY {
                words.push(format!(
                    "on this heading the compass hardly shows {what}: such steps cannot be \
                     checked on the spot (lambda does not depend on the heading)"
                ));
            }
        }
        words
    }
}
