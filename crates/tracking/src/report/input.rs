//! Input of an analysis, and its parts in order of time.

use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::azimuth::Azimuth;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;

/// Input of an analysis of one compass.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Samples in any order, with repetitions or without.
    pub samples: &'a [Sample],
    /// Logbook of the vessel.
    pub logbook: &'a [LogbookEntry],
    /// Azimuths taken with this compass.
    pub azimuths: &'a [Azimuth],
    /// Prior knowledge of the vessel.
    pub prior: &'a ShipPrior,
    /// Settings of the operator.
    pub settings: AnalysisSettings,
}

/// Part of a voyage, with what was known at its end: a segment, or all that is later than the
/// parts before.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// Samples later than those of the parts before, in any order, with repetitions or without.
    pub samples: &'a [Sample],
    /// Entries that began before its end, open where they ended later.
    pub logbook: Vec<LogbookEntry>,
    /// Azimuths taken before its end.
    pub azimuths: Vec<Azimuth>,
    /// Instant after its end; none of the last part.
    pub end: Option<Timestamp>,
}

impl<'a> Part<'a> {
    /// Makes a part that ends at some time, or the last one, from a whole logbook and all azimuths.
    pub fn new(
        samples: &'a [Sample],
        logbook: &[LogbookEntry],
        azimuths: &[Azimuth],
        end: Option<Timestamp>,
    ) -> Part<'a> {
        let is_within = |time: Timestamp| end.is_none_or(|end| time < end);
        let known = |entry: &LogbookEntry| match end {
            Some(end) => entry.known_before(end),
            None => Some(entry.clone()),
        };
        let azimuths = azimuths.iter().filter(|azimuth| is_within(azimuth.time()));
        Part {
            samples,
            logbook: logbook.iter().filter_map(known).collect(),
            azimuths: azimuths.cloned().collect(),
            end,
        }
    }
}
