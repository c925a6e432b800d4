//! The advice itself, as it is printed, stored and shown.

use serde::{Deserialize, Serialize};

/// What to sail next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SailNext {
    /// Length of a watch, hours.
    pub watch_hours: f64,
    /// What is left of the band when all is learnt that headings can show: half
    /// of it, from the reference's own constant error, degrees.
    pub floor_deg: f64,
    /// The headings to sail here, for the band here.
    pub here: Advice<HeadingSuggestion>,
    /// The magnetic latitudes to visit, for the band in other waters; none
    /// where the model holds nowhere else.
    pub elsewhere: Option<Advice<LatitudeSuggestion>>,
}

/// The band in some waters and how to narrow it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Advice<S> {
    /// The band now.
    pub band: Band,
    /// Nothing sailed can narrow the band's root mean square by more, degrees.
    pub narrows_at_most_deg: f64,
    /// What narrows it most, the best first; empty where nothing does noticeably.
    pub suggestions: Vec<S>,
}

/// Half the width of the 95 % band over all headings in some waters, degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Root mean square.
    pub rms_deg: f64,
    /// On the worst heading.
    pub worst_deg: f64,
}

/// A range of compass headings, clockwise from one to the other; it may pass
/// north, and 0 to 360 is any heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HeadingRange {
    /// First heading, degrees, 0 to 345.
    pub heading_from_deg: u16,
    /// Last heading, degrees, 15 to 360.
    pub heading_to_deg: u16,
}

/// Headings on which a watch is worth having.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeadingSuggestion {
    /// Anywhere in this range.
    #[serde(flatten)]
    pub range: HeadingRange,
    /// The band after a watch on any heading of the range, at most.
    pub after_one: Band,
    /// The band after three watches on one heading of the range, at most.
    pub after_three: Band,
}

/// Magnetic latitudes in which a watch is worth having.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LatitudeSuggestion {
    /// Southern edge, degrees of magnetic latitude, north positive.
    pub magnetic_latitude_from_deg: i16,
    /// Northern edge.
    pub magnetic_latitude_to_deg: i16,
    /// On which headings to stand three watches there, in this order.
    pub headings: Vec<HeadingRange>,
    /// The band after the first of them, at most.
    pub after_one: Band,
    /// The band after all three, at most.
    pub after_three: Band,
}
