//! A ship's heading alongside, given or learnt from earlier calls.

use crate::ports::PortCode;
use serde::{Deserialize, Serialize};

/// A heading alongside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = PlannedBerthHeading))]
pub struct BerthHeading {
    /// Degrees, true.
    pub heading_deg: f64,
    /// Source of the heading: `given`, or earlier calls at the same `berth` or `port`.
    #[cfg_attr(feature = "openapi", schema(value_type = String))]
    pub source: HeadingSource,
}

/// The source of a heading alongside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HeadingSource {
    /// Given for this call.
    Given,
    /// Mean of earlier calls at the same berth.
    Berth,
    /// Mean of earlier calls at the same port.
    Port,
}

/// A heading observed at an earlier call of any ship.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Observed {
    /// The port.
    pub port: PortCode,
    /// The berth, if known.
    #[serde(default)]
    pub berth: Option<String>,
    /// Degrees, true.
    pub heading_deg: f64,
}

/// Returns the given heading of a call, or the mean at the same berth or port.
/// Ships lie either way along a quay, and berths of a port differ: `None` where
/// the headings do not agree to about ±25°.
pub fn berth_heading(call: &super::PortCall, earlier: &[Observed]) -> Option<BerthHeading> {
    if let Some(heading_deg) = call.berth_heading_deg {
        return Some(BerthHeading {
            heading_deg,
            source: HeadingSource::Given,
        });
    }
    let in_port = || earlier.iter().filter(|seen| seen.port == call.port);
    let here = in_port().filter(|seen| call.berth.is_some() && seen.berth == call.berth);
    let of = |source, heading| {
        Some(BerthHeading {
            heading_deg: heading,
            source,
        })
    };
    match mean(here.map(|seen| seen.heading_deg)) {
        Some(heading) => of(HeadingSource::Berth, heading),
        None => of(
            HeadingSource::Port,
            mean(in_port().map(|seen| seen.heading_deg))?,
        ),
    }
}

/// Returns the mean direction, where the directions agree (resultant length 0.9 or
/// more).
fn mean(headings: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut north, mut east, mut count) = (0.0, 0.0, 0.0);
    for heading in headings {
        let (sin, cos) = heading.to_radians().sin_cos();
        north += cos;
        east += sin;
        count += 1.0;
    }
    if count == 0.0 || north.hypot(east) < 0.9 * count {
        return None;
    }
    let mean = east.atan2(north).to_degrees().rem_euclid(360.0);
    Some(if mean < 360.0 { mean } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calls::PortCall;
    use serde_json::{from_value, json};

    fn call(berth: Option<&str>) -> PortCall {
        from_value(
            json!({"id": "c", "vessel": "v", "port": "NLRTM", "berth": berth,
            "eta": "2026-12-01T06:00:00Z", "etd": "2026-12-03T06:00:00Z"}),
        )
        .unwrap()
    }

    fn seen(port: &str, berth: &str, heading_deg: f64) -> Observed {
        from_value(json!({"port": port, "berth": berth, "heading_deg": heading_deg})).unwrap()
    }

    #[test]
    fn a_heading_is_learnt_from_the_same_berth_across_north() {
        let earlier = [
            seen("NLRTM", "A1", 350.0),
            seen("NLRTM", "A1", 10.0),
            seen("NLRTM", "B2", 90.0),
        ];
        let learnt = berth_heading(&call(Some("A1")), &earlier).unwrap();
        assert_eq!(learnt.source, HeadingSource::Berth);
        assert!(learnt.heading_deg.min(360.0 - learnt.heading_deg) < 1e-9);
    }

    #[test]
    fn headings_that_disagree_teach_nothing() {
        let earlier = [
            seen("NLRTM", "A1", 80.0),
            seen("NLRTM", "A1", 260.0),
            seen("BEANR", "A1", 80.0),
        ];
        assert_eq!(berth_heading(&call(Some("A1")), &earlier), None);
    }

    #[test]
    fn a_given_heading_stands_and_another_berth_of_the_port_may_do() {
        let earlier = [seen("NLRTM", "A1", 80.0)];
        let learnt = berth_heading(&call(None), &earlier).unwrap();
        assert_eq!(
            (learnt.source, learnt.heading_deg.round()),
            (HeadingSource::Port, 80.0)
        );
        let mut given = call(None);
        given.berth_heading_deg = Some(123.0);
        let given = berth_heading(&given, &earlier).unwrap();
        assert_eq!(
            (given.source, given.heading_deg),
            (HeadingSource::Given, 123.0)
        );
    }
}
