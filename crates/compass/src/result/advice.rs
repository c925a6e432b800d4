//! Sailing advice, as printed, stored and displayed.

use serde::{Deserialize, Serialize};

/// Headings and magnetic latitudes that would narrow the band most.
///
/// A watch is four hours on one compass heading. Three watches are on three successive days.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct SailNext {
    /// Length of a watch, hours.
    pub watch_hours: f64,
    /// Remaining band after headings have shown everything that they can: half its width,
    /// from the reference's own constant error, degrees.
    pub floor_deg: f64,
    /// Headings to sail here, for the band here.
    #[cfg_attr(feature = "openapi", schema(value_type = HeadingAdvice))]
    pub here: Advice<HeadingSuggestion>,
    /// Magnetic latitudes to visit, for the band elsewhere; none where the model holds
    /// nowhere else.
    #[cfg_attr(feature = "openapi", schema(required, value_type = Option<LatitudeAdvice>))]
    pub elsewhere: Option<Advice<LatitudeSuggestion>>,
    /// Azimuths to take, for the band here; none where they would hardly narrow it.
    #[serde(default)]
    #[cfg_attr(feature = "openapi", schema(required))]
    pub azimuths: Option<AzimuthAdvice>,
}

/// Effect of azimuths of the sun, or of another body or a transit, on the band here.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct AzimuthAdvice {
    /// Standard error of one azimuth, degrees.
    #[cfg_attr(feature = "openapi", schema(example = 0.7))]
    pub standard_error_deg: f64,
    /// Present band.
    pub band: Band,
    /// Greatest band after one azimuth on any heading.
    pub after_one: Band,
    /// Band after twenty azimuths on headings all round.
    pub after_twenty: Band,
}

/// Band in some waters, with suggestions that narrow it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Advice<S> {
    /// Present band.
    pub band: Band,
    /// Greatest possible reduction of the band's root mean square, degrees.
    pub narrows_at_most_deg: f64,
    /// Suggestions, the most effective first; empty where none has a noticeable effect.
    pub suggestions: Vec<S>,
}

/// Half the width of the 95 % band over all headings in some waters, degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Band {
    /// Root mean square, degrees.
    pub rms_deg: f64,
    /// Band on the worst heading, degrees.
    pub worst_deg: f64,
}

/// A range of compass headings, clockwise from first to last. It may pass north; 0 to 360
/// is any heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct HeadingRange {
    /// First heading, degrees, 0 to 345.
    pub heading_from_deg: u16,
    /// Last heading, degrees, 15 to 360.
    pub heading_to_deg: u16,
}

/// A range of headings on which a watch narrows the band.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct HeadingSuggestion {
    /// Range of headings.
    #[serde(flatten)]
    #[cfg_attr(feature = "openapi", schema(inline))]
    pub range: HeadingRange,
    /// Greatest band after one watch on any heading of the range.
    pub after_one: Band,
    /// Greatest band after three watches on one heading of the range.
    pub after_three: Band,
}

/// A range of magnetic latitudes in which a watch narrows the band.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct LatitudeSuggestion {
    /// Southern edge, degrees of magnetic latitude, north positive.
    pub magnetic_latitude_from_deg: i16,
    /// Northern edge, degrees of magnetic latitude, north positive.
    pub magnetic_latitude_to_deg: i16,
    /// Headings of three watches there, in this order.
    pub headings: Vec<HeadingRange>,
    /// Greatest band after the first watch.
    pub after_one: Band,
    /// Greatest band after all three watches.
    pub after_three: Band,
}

/// Schema of the advice on headings.
#[cfg(feature = "openapi")]
enum HeadingAdvice {}

/// Schema of the advice on magnetic latitudes.
#[cfg(feature = "openapi")]
enum LatitudeAdvice {}

#[cfg(feature = "openapi")]
crate::openapi::named_schema!(
    HeadingAdvice,
    "HeadingAdvice",
    Advice<HeadingSuggestion>,
    HeadingSuggestion
);
#[cfg(feature = "openapi")]
crate::openapi::named_schema!(
    LatitudeAdvice,
    "LatitudeAdvice",
    Advice<LatitudeSuggestion>,
    LatitudeSuggestion
);
