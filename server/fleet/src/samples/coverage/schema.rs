//! OpenAPI descriptions of coverage, advice and the comparison of references. Science crates own
//! the types.

use utoipa::ToSchema;

/// Coverage of a compass's samples.
#[derive(ToSchema)]
#[schema(as = Coverage)]
#[allow(dead_code, reason = "describes analysis::Covered")]
pub(super) struct CoverageSchema {
    /// Width of a heading sector, degrees.
    heading_step_deg: u16,
    /// Width of a band of magnetic latitude, degrees.
    magnetic_latitude_step_deg: i16,
    /// The bands that hold samples, from south to north.
    bands: Vec<CoverageBandSchema>,
    /// The cells that hold samples, by band and then by heading.
    cells: Vec<CoverageCellSchema>,
    /// Advice on what to sail next to narrow the 95 % band most; none without a model.
    #[schema(required)]
    sail_next: Option<SailNextSchema>,
    /// Comparison of gyro and satellite compass. None before the first analysis, and where a model
    /// is refused because they disagree.
    #[schema(required)]
    references: Option<ReferencesSchema>,
}

/// Comparison of gyro and satellite compass over the samples since the last change of the ship or
/// the compass.
#[derive(ToSchema)]
#[schema(as = References)]
#[allow(
    dead_code,
    reason = "describes binnacle_compass::result::ReferenceCheck"
)]
struct ReferencesSchema {
    /// Samples with both.
    pairs: u64,
    /// Gyro less satellite compass, usually, degrees; none without enough pairs.
    #[schema(required)]
    offset_deg: Option<f64>,
    /// One of the two has failed where their difference departs further than this
    /// from the usual, degrees.
    failed_beyond_deg: f64,
    /// Standard deviation of the constant error that is left in the reference,
    /// degrees.
    constant_sd_deg: f64,
    /// Samples whose gyro was dropped.
    gyro_dropped: u64,
    /// Samples whose satellite compass was dropped.
    satellite_dropped: u64,
}

/// The range of fields in one band of magnetic latitude.
#[derive(ToSchema)]
#[schema(as = CoverageBand)]
#[allow(
    dead_code,
    reason = "describes binnacle_compass::coverage::CoverageBand"
)]
struct CoverageBandSchema {
    /// The band's southern edge, degrees of magnetic latitude.
    magnetic_latitude_from_deg: i16,
    h_nt_from: f64,
    h_nt_to: f64,
    z_nt_from: f64,
    z_nt_to: f64,
    samples: u64,
}

/// One sector of heading within one band.
#[derive(ToSchema)]
#[schema(as = CoverageCell)]
#[allow(
    dead_code,
    reason = "describes binnacle_compass::coverage::CoverageCell"
)]
struct CoverageCellSchema {
    /// The sector's first compass heading, degrees.
    heading_from_deg: u16,
    /// The band's southern edge, degrees of magnetic latitude.
    magnetic_latitude_from_deg: i16,
    samples: u64,
}

/// Advice on what to sail next. A watch is four hours on one compass heading; three watches are on
/// three successive days.
#[derive(ToSchema)]
#[schema(as = SailNext)]
#[allow(dead_code, reason = "describes binnacle_compass::result::SailNext")]
struct SailNextSchema {
    /// Length of a watch, hours.
    watch_hours: f64,
    /// Half the band that is left when all is learnt that headings can show:
    /// the reference's own constant error, degrees.
    floor_deg: f64,
    /// The headings to sail here, for the band here.
    here: HeadingAdviceSchema,
    /// The magnetic latitudes to visit, for the band in other waters; none where
    /// the model holds nowhere else.
    #[schema(required)]
    elsewhere: Option<LatitudeAdviceSchema>,
}

/// The band where the ship is, and the headings that narrow it.
#[derive(ToSchema)]
#[schema(as = HeadingAdvice)]
#[allow(dead_code, reason = "describes binnacle_compass::result::Advice")]
struct HeadingAdviceSchema {
    band: BandSchema,
    /// Nothing sailed can narrow the band's root mean square by more, degrees.
    narrows_at_most_deg: f64,
    /// The best first; empty where nothing narrows it noticeably.
    suggestions: Vec<HeadingSuggestionSchema>,
}

/// The band in other waters, and the magnetic latitudes that narrow it.
#[derive(ToSchema)]
#[schema(as = LatitudeAdvice)]
#[allow(dead_code, reason = "describes binnacle_compass::result::Advice")]
struct LatitudeAdviceSchema {
    band: BandSchema,
    /// Nothing sailed can narrow the band's root mean square by more, degrees.
    narrows_at_most_deg: f64,
    /// The best first; empty where nothing narrows it noticeably.
    suggestions: Vec<LatitudeSuggestionSchema>,
}

/// Half the width of the 95 % band over all headings in some waters, degrees.
#[derive(ToSchema)]
#[schema(as = Band)]
#[allow(dead_code, reason = "describes binnacle_compass::result::Band")]
struct BandSchema {
    /// Root mean square.
    rms_deg: f64,
    /// On the worst heading.
    worst_deg: f64,
}

/// Compass headings clockwise from one to the other: the range may pass north,
/// and 0 to 360 is any heading.
#[derive(ToSchema)]
#[schema(as = HeadingRange)]
#[allow(dead_code, reason = "describes binnacle_compass::result::HeadingRange")]
struct HeadingRangeSchema {
    heading_from_deg: u16,
    heading_to_deg: u16,
}

/// Headings on which a watch is worth having; the range as in `HeadingRange`.
#[derive(ToSchema)]
#[schema(as = HeadingSuggestion)]
#[allow(
    dead_code,
    reason = "describes binnacle_compass::result::HeadingSuggestion"
)]
struct HeadingSuggestionSchema {
    heading_from_deg: u16,
    heading_to_deg: u16,
    /// At most, after a watch on any heading of the range.
    after_one: BandSchema,
    /// At most, after three watches on one heading of the range.
    after_three: BandSchema,
}

/// Magnetic latitudes in which a watch is worth having.
#[derive(ToSchema)]
#[schema(as = LatitudeSuggestion)]
#[allow(
    dead_code,
    reason = "describes binnacle_compass::result::LatitudeSuggestion"
)]
struct LatitudeSuggestionSchema {
    /// Southern edge, degrees of magnetic latitude, north positive.
    magnetic_latitude_from_deg: i16,
    magnetic_latitude_to_deg: i16,
    /// On which headings to stand three watches there, in this order.
    headings: Vec<HeadingRangeSchema>,
    /// At most, after the first of them.
    after_one: BandSchema,
    /// At most, after all three.
    after_three: BandSchema,
}
