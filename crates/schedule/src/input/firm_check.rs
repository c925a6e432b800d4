//! Checks that a firm can be scheduled.

use super::Firm;
use crate::ports;
use std::collections::BTreeSet;

/// The reason why a firm cannot be scheduled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {detail}")]
pub struct FirmError {
    /// The field at fault.
    pub field: &'static str,
    /// The fault in it.
    pub detail: String,
    /// True if the only fault is that it has no working days or no ports.
    pub idle: bool,
}

/// Checks a firm; idleness is checked last.
///
/// # Errors
/// The first fault.
pub fn check_firm(firm: &Firm) -> Result<(), FirmError> {
    let wrong = |field, detail: &str| {
        let (detail, idle) = (detail.to_owned(), false);
        Err(FirmError {
            field,
            detail,
            idle,
        })
    };
    if firm.teams > 1000 {
        return wrong("teams", "more than 1000");
    }
    if !(1..=20).contains(&firm.jobs_a_team_day) {
        return wrong("jobs_a_team_day", "is not within 1 to 20");
    }
    let hours = 0.0..=24.0;
    if !hours.contains(&firm.first_hour) {
        return wrong("first_hour", "is not within 0 to 24");
    }
    if !hours.contains(&firm.last_hour) || firm.last_hour <= firm.first_hour {
        return wrong("last_hour", "is not after first_hour and up to 24");
    }
    if !(0.0..=8760.0).contains(&firm.lead_time_h) {
        return wrong("lead_time_h", "is not within 0 to 8760");
    }
    let mut served = BTreeSet::new();
    for port in &firm.ports {
        if ports::find(port.port).is_none() {
            return wrong("ports", &ports::describe_unknown(port.port));
        }
        if !served.insert(port.port) {
            return wrong("ports", &format!("{} appears twice", port.port));
        }
    }
    let idle = |field, detail: &str| {
        let (detail, idle) = (detail.to_owned(), true);
        Err(FirmError {
            field,
            detail,
            idle,
        })
    };
    if firm.working_days.is_empty() {
        return idle(
            "working_days",
            "a firm that works on no day of the week serves nobody",
        );
    }
    if firm.ports.is_empty() {
        return idle("ports", "a firm without ports serves nobody");
    }
    Ok(())
}
