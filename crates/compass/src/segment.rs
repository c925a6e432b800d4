//! Segments of a compass's samples.

use crate::time::Timestamp;

/// Segment of a compass's samples: 10 days, counted from 1970.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Segment(i64);

impl Segment {
    /// Length, microseconds: 10 days. A new batch is read with those of its segment, and a state
    /// is kept at the end of each.
    pub const MICROS: i64 = 10 * 86_400 * 1_000_000;

    /// Returns the segment of a number.
    pub fn new(number: i64) -> Segment {
        Segment(number)
    }

    /// Returns the segment in which a time lies.
    pub fn of(time: Timestamp) -> Segment {
        Segment(time.micros().div_euclid(Segment::MICROS))
    }

    /// Returns its number.
    pub fn number(self) -> i64 {
        self.0
    }

    /// Returns its beginning; none before the first year of a timestamp.
    pub fn begin(self) -> Option<Timestamp> {
        Timestamp::from_micros(self.0.checked_mul(Segment::MICROS)?).ok()
    }

    /// Returns the instant after its end; none after the last year of a timestamp.
    pub fn end(self) -> Option<Timestamp> {
        Segment(self.0.checked_add(1)?).begin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_has_the_times_from_its_beginning_until_before_its_end() {
        let time = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        let segment = Segment::of(time);
        let (begin, end) = (segment.begin().unwrap(), segment.end().unwrap());
        assert!(begin <= time && time < end);
        assert_eq!(end.micros() - begin.micros(), Segment::MICROS);
        assert_eq!(Segment::of(begin), segment);
        assert_eq!(Segment::of(end), Segment::new(segment.number() + 1));
    }

    #[test]
    fn a_segment_beyond_all_times_has_no_ends() {
        assert_eq!(Segment::new(i64::MAX).begin(), None);
        assert_eq!(Segment::new(i64::MAX).end(), None);
    }
}
