//! Input of an analysis.

use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::azimuth::Azimuth;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;

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
