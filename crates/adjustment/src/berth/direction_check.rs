//! Comparison of the field's direction at the berth with the model's.

use super::consistency::{Consistency, Verdict};
use super::expected_field::{ExpectedField, Vector, dot};
use super::reading::BerthReading;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::model::Covariance;
use binnacle_compass::ship::{EarthField, compass_rad};

/// Greatest angle that the given errors explain, in standard errors: two-sided 99.7 %, so
/// that one sound berth in 370 is refused.
const EXPLAINED_SD: f64 = 3.0;
/// Greatest angle of a good berth, degrees, however wide its errors.
const GOOD_DEG: f64 = 1.0;

/// Compares the direction of the measured field with the expected one.
pub(super) fn check_direction(
    expected: &ExpectedField,
    earth: EarthField,
    reading: &BerthReading,
    covariance: Option<&Covariance>,
) -> Consistency {
    let (b, u) = (reading.field_nt(), expected.u);
    let angle_deg = wrap_180((compass_rad(b[0], b[1]) - compass_rad(u[0], u[1])).to_degrees());
    let by_u = compass_slope(u).map(|slope| -slope);
    let standard_error_deg = expected
        .spread(reading, earth, compass_slope(b), by_u)
        .standard_error(covariance)
        .map(f64::to_degrees);
    Consistency {
        angle_deg,
        standard_error_deg,
        across_nt: b[0].hypot(b[1]) * angle_deg.to_radians().sin().abs(),
        verdict: verdict(angle_deg.abs(), standard_error_deg),
    }
}

fn verdict(angle_deg: f64, standard_error_deg: Option<f64>) -> Verdict {
    let explained = standard_error_deg.map_or(GOOD_DEG, |error| EXPLAINED_SD * error);
    if angle_deg > explained {
        Verdict::Inconsistent
    } else if angle_deg > GOOD_DEG {
        Verdict::Loose
    } else {
        Verdict::Consistent
    }
}

/// Returns the slopes of the compass heading by the field, radians per nT.
fn compass_slope(field: Vector) -> Vector {
    let squared = dot(field, field);
    [field[1] / squared, -field[0] / squared]
}
