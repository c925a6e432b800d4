//! The settings of a run of the fleet.

use crate::cli::FleetArgs;
use binnacle_compass::time::Timestamp;
use binnacle_simulator::scenario::Scenario;

/// The settings of a run.
pub(super) struct Run<'a> {
    pub(super) args: &'a FleetArgs,
    pub(super) scenario: Scenario,
    pub(super) seed: u64,
    pub(super) from: Timestamp,
    pub(super) until: Timestamp,
}
