//! Detectors that the study can judge, by name.

use crate::voyages::Variety;
use crate::voyages::fleet::{Event, Log, Plan};
use binnacle_analysis::analyse::analyse;
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::Analysis;
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;

/// Function from samples and logbook to epochs and changes.
pub(crate) type Detector = fn(&[Sample], &[LogbookEntry], &AnalysisSettings) -> Analysis;

/// Detectors and their names on the command line.
pub(crate) const DETECTORS: [(&str, Detector); 2] = [("old", analyse), ("new", by_hypotheses)];

/// Analyses by weighed hypotheses, with nothing known of sisters.
fn by_hypotheses(
    samples: &[Sample],
    logbook: &[LogbookEntry],
    settings: &AnalysisSettings,
) -> Analysis {
    binnacle_tracking::analyse(&binnacle_tracking::Input {
        samples,
        logbook,
        azimuths: &[],
        prior: &ShipPrior::population(),
        settings: *settings,
    })
}

/// Returns the detector of a name.
pub(crate) fn find(name: &str) -> Result<Detector, String> {
    let mut detectors = DETECTORS.iter();
    let found = detectors.find(|(known, _)| *known == name);
    found
        .map(|(_, detector)| *detector)
        .ok_or_else(|| format!("no detector {name}"))
}

/// Analyses a whole voyage.
pub(crate) fn run(detector: Detector, log: &Log) -> Analysis {
    detector(&log.samples, &log.logbook, &AnalysisSettings::default())
}

/// Analyses a voyage as known at a time.
pub(crate) fn run_until(detector: Detector, log: &Log, until: Timestamp) -> Analysis {
    let count = log.samples.partition_point(|s| s.time <= until);
    let known = log.logbook.iter().filter(|entry| entry.from <= until);
    let logbook: Vec<LogbookEntry> = known.map(|entry| entry.as_of(until)).collect();
    detector(
        &log.samples[..count],
        &logbook,
        &AnalysisSettings::default(),
    )
}

/// Returns the usual plan of a seed's ship: three kinds of trade.
pub(crate) fn plan(seed: u64, event: Event) -> Plan {
    let varieties = [Variety::Rich, Variety::Medium, Variety::Poor];
    let mut plan = Plan::new(event, varieties[(seed % 3) as usize]);
    plan.habits.has_course_over_ground = true;
    plan
}

/// Leaves the ship with a gyro alone. Such a gyro has no faults by chance: nothing could
/// tell them from the ship's own changes.
pub(crate) fn leave_gyro_alone(plan: &mut Plan) {
    plan.faults.satellite = false;
    plan.gyro_faults = 0.0;
}
