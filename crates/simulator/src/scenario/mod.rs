//! A scenario: ships, routes, instruments and events, read from TOML.
//!
//! Invariants of a [`Scenario`]: every number is finite and within a ship's
//! capability, every route is named and long enough, and every compass can be
//! steered by wherever its ship sails.

mod check;
mod definition;
mod error;
mod event;
mod raw;
mod ship;
mod values;

pub use definition::{
    Anomaly, DisplayPlan, Event, GyroPlan, LineFaults, RoutePoint, SatellitePlan, Scenario,
    ShipPlan, Storm, Timing,
};
pub use error::ScenarioError;

use std::path::Path;

impl Scenario {
    /// Reads a scenario from a file.
    ///
    /// # Errors
    /// Fails when the file cannot be read or is not a scenario; the error names the
    /// file, the line and the field.
    pub fn read(path: &Path) -> Result<Scenario, ScenarioError> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| ScenarioError::Unreadable {
            file: file.clone(),
            error: error.to_string(),
        })?;
        Scenario::parse(&file, &text)
    }

    /// Reads a scenario from text; `file` is used in errors.
    ///
    /// # Errors
    /// Fails when the text is not a scenario.
    pub fn parse(file: &str, text: &str) -> Result<Scenario, ScenarioError> {
        let source = error::Source { file, text };
        let raw = toml::from_str(text).map_err(|error| source.toml(&error))?;
        check::scenario(&source, &raw)
    }

    /// Finds the ship of this name.
    pub fn ship(&self, name: &str) -> Option<&ShipPlan> {
        self.ships.iter().find(|ship| ship.name == name)
    }
}
