//! Heading of one instrument over the windows, unwound across north.

use binnacle_compass::angle::wrap_180;
use binnacle_compass::sample::SourceId;
use binnacle_instruments::Refusal;

/// Heading in one window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeadingSpan {
    /// Mean of the readings, unwound.
    pub(super) mean: f64,
    /// Lowest reading, unwound.
    low: f64,
    /// Highest reading, unwound.
    high: f64,
    /// Number of readings.
    pub(super) readings: u32,
}

/// Readings of one instrument: the open window and the two before it.
#[derive(Clone, Debug, Default)]
pub(super) struct HeadingTrack {
    /// Latest reading, in degrees that continue past a full circle.
    unwound: Option<f64>,
    sum: f64,
    low: f64,
    high: f64,
    readings: u32,
    invalid: bool,
    refusal: Option<Refusal>,
    source: Option<SourceId>,
    earlier: [Option<HeadingSpan>; 2],
}

impl HeadingTrack {
    /// Adds a heading in degrees.
    pub(super) fn add(&mut self, degrees: f64) {
        let unwound = match self.unwound {
            Some(last) => last + wrap_180(degrees - last),
            None => degrees,
        };
        self.unwound = Some(unwound);
        if self.readings == 0 {
            (self.sum, self.low, self.high) = (0.0, unwound, unwound);
        }
        self.sum += unwound;
        self.low = self.low.min(unwound);
        self.high = self.high.max(unwound);
        self.readings += 1;
    }

    /// Adds a heading of a named source. Another source begins anew: headings of two
    /// instruments are never mixed.
    pub(super) fn add_from(&mut self, source: SourceId, degrees: f64) {
        if self.source != Some(source) {
            self.forget();
            self.source = Some(source);
        }
        self.add(degrees);
    }

    /// Returns the source of the readings.
    pub(super) fn source(&self) -> Option<SourceId> {
        self.source
    }

    /// Marks the window as invalid: the instrument reported itself as not to be trusted.
    pub(super) fn invalidate(&mut self) {
        self.invalid = true;
    }

    /// Marks the window as one whose heading must not be used.
    pub(super) fn refuse(&mut self, refusal: Refusal) {
        self.refusal = Some(refusal);
    }

    /// Returns the reason why the window's heading must not be used.
    pub(super) fn refusal(&self) -> Option<Refusal> {
        self.refusal
    }

    /// Returns the heading in the open window, if it has readings.
    pub(super) fn span(&self) -> Option<HeadingSpan> {
        if self.readings == 0 || self.invalid || self.refusal.is_some() {
            return None;
        }
        Some(HeadingSpan {
            mean: self.sum / f64::from(self.readings),
            low: self.low,
            high: self.high,
            readings: self.readings,
        })
    }

    /// Returns the peak-to-peak range of the heading over this window and the two before it: thirty
    /// seconds.
    pub(super) fn swing_deg(&self) -> f64 {
        let spans = self.earlier.iter().copied().chain([self.span()]).flatten();
        let (low, high) = spans.fold((f64::MAX, f64::MIN), |(low, high), span| {
            (low.min(span.low), high.max(span.high))
        });
        (high - low).max(0.0)
    }

    /// Returns the change of the mean since the previous window, if both had readings.
    pub(super) fn moved_deg(&self) -> Option<f64> {
        Some(self.span()?.mean - self.earlier[0]?.mean)
    }

    /// Closes the window.
    pub(super) fn close(&mut self) {
        self.earlier = [self.span(), self.earlier[0]];
        self.readings = 0;
        self.invalid = false;
        self.refusal = None;
    }

    /// Discards the previous windows, which no longer adjoin this one.
    pub(super) fn forget(&mut self) {
        *self = HeadingTrack::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::angle::wrap_360;

    #[test]
    fn a_mean_across_north_is_north() {
        let mut track = HeadingTrack::default();
        for degrees in [359.0, 1.0, 358.0, 2.0] {
            track.add(degrees);
        }
        let mean = wrap_180(track.span().unwrap().mean);
        assert!(mean.abs() < 1e-9, "{}", wrap_360(mean));
        assert!((track.swing_deg() - 4.0).abs() < 1e-9);
    }

    #[test]
    fn swing_looks_back_two_windows_and_no_further() {
        let mut track = HeadingTrack::default();
        track.add(10.0);
        track.close();
        for _ in 0..2 {
            track.add(20.0);
            assert!((track.swing_deg() - 10.0).abs() < 1e-9);
            track.close();
        }
        track.add(20.0);
        assert!(track.swing_deg() < 1e-9);
    }

    #[test]
    fn another_source_begins_anew() {
        let mut track = HeadingTrack::default();
        let [first, second] = ["gyro 1", "gyro 2"].map(SourceId::from_name);
        track.add_from(first, 10.0);
        track.close();
        track.add_from(first, 10.0);
        track.add_from(second, 20.0);
        track.add_from(second, 22.0);
        let span = track.span().unwrap();
        assert_eq!((track.source(), span.readings), (Some(second), 2));
        assert!((span.mean - 21.0).abs() < 1e-9);
        assert_eq!(track.moved_deg(), None);
    }

    #[test]
    fn an_invalid_reading_spoils_its_window_only() {
        let mut track = HeadingTrack::default();
        track.add(10.0);
        track.invalidate();
        assert_eq!(track.span(), None);
        track.close();
        track.add(10.0);
        assert!(track.span().is_some());
    }
}
