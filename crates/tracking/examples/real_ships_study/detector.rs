//! Analyses of simulated voyages, and the plans of their ships.

use crate::voyages::Variety;
use crate::voyages::fleet::{Event, Log, Plan};
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::Analysis;
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use binnacle_tracking::Input;

/// Analyses samples with nothing known of sisters.
pub(crate) fn analyse(samples: &[Sample], logbook: &[LogbookEntry]) -> Analysis {
    binnacle_tracking::analyse(&Input {
        samples,
        logbook,
        azimuths: &[],
        prior: &ShipPrior::population(),
        settings: AnalysisSettings::default(),
    })
}

/// Analyses a whole voyage.
pub(crate) fn run(log: &Log) -> Analysis {
    analyse(&log.samples, &log.logbook)
}

/// Analyses a voyage as known at a time.
pub(crate) fn run_until(log: &Log, until: Timestamp) -> Analysis {
    let count = log.samples.partition_point(|s| s.time <= until);
    let known = log.logbook.iter().filter(|entry| entry.from <= until);
    let logbook: Vec<LogbookEntry> = known.map(|entry| entry.as_of(until)).collect();
    analyse(&log.samples[..count], &logbook)
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
