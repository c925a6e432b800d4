//! The corrected heading as deltas to a Signal K server.
//!
//! Signal K 1.7, "Keys reference (vessel)": radians, east positive; `navigation.headingMagnetic` has
//! the deviation applied that `navigation.magneticDeviation` states. The server gives the time. The
//! paths are of its own schema, with its own metadata.
//!
//! Invariant: while the heading is withheld, its values are null.

use crate::config::SignalKOutputConfig;
use crate::heading::{Heading, Schedule, Trigger};
use binnacle_compass::angle::{Deviation, MagneticHeading, TrueHeading, Variation};
use binnacle_input::{Port, PortEnd, PortEvent};
use serde_json::json;
use std::time::Duration;
use tokio::time::Instant;

/// Digits of a value: a hundredth of a degree.
const STEPS_PER_RAD: f64 = 1e4;

/// Output to a server.
#[derive(Debug)]
pub(crate) struct SignalKOutput {
    label: String,
    schedule: Schedule,
    port: Port<String>,
    is_open: bool,
}

impl SignalKOutput {
    /// Creates an output, and the input's end of its connection.
    pub(crate) fn new(
        config: &SignalKOutputConfig,
        interval_s: f64,
    ) -> (SignalKOutput, PortEnd<String>) {
        let (port, end) = Port::new();
        let output = SignalKOutput {
            label: config.label.as_str().to_owned(),
            schedule: Schedule::new(interval_s),
            port,
            is_open: false,
        };
        (output, end)
    }

    /// Returns the `$source` of its values.
    pub(crate) fn label(&self) -> &str {
        &self.label
    }

    /// Returns the time of the next [`Trigger::Timer`].
    pub(crate) fn next_timer(&self, compass_interval: Duration, now: Instant) -> Instant {
        self.schedule.timer(compass_interval).unwrap_or(now)
    }

    /// Sends the heading if it is due.
    pub(crate) fn send(
        &mut self,
        heading: &Heading,
        trigger: Trigger,
        compass_interval: Duration,
        now: Instant,
    ) {
        while let Ok(event) = self.port.events.try_recv() {
            self.is_open = event == PortEvent::Opened;
            self.schedule.reset();
        }
        let is_due = self
            .schedule
            .take_due(heading, trigger, compass_interval, now);
        if !is_due {
            return;
        }
        if self.is_open && !self.port.send(delta(&self.label, heading)) {
            tracing::debug!(label = self.label, "the server takes no deltas");
        }
    }
}

fn delta(label: &str, heading: &Heading) -> String {
    let is_withheld = heading.true_heading.is_none();
    let deviation = heading.deviation.filter(|_| !is_withheld);
    let radians = |degrees: f64| (degrees.to_radians() * STEPS_PER_RAD).round() / STEPS_PER_RAD;
    let values = [
        (
            "headingMagnetic",
            heading.magnetic().map(MagneticHeading::degrees),
        ),
        (
            "headingTrue",
            heading.true_heading.map(TrueHeading::degrees),
        ),
        ("magneticDeviation", deviation.map(Deviation::degrees_east)),
        (
            "magneticVariation",
            heading.variation.map(Variation::degrees_east),
        ),
    ];
    let values = values.map(|(path, degrees)| {
        json!({"path": format!("navigation.{path}"), "value": degrees.map(radians)})
    });
    let update = json!({"$source": label, "values": values});
    json!({"context": "vessels.self", "updates": [update]}).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    fn values(heading: &Heading) -> [Option<f64>; 4] {
        let delta: Value = serde_json::from_str(&delta("binnacle", heading)).unwrap();
        let update = &delta["updates"][0];
        assert_eq!(update["$source"], "binnacle");
        let values = update["values"].as_array().unwrap();
        [
            "headingMagnetic",
            "headingTrue",
            "magneticDeviation",
            "magneticVariation",
        ]
        .map(|name| {
            let path = format!("navigation.{name}");
            let value = values.iter().find(|value| value["path"] == path);
            value.unwrap()["value"].as_f64().map(f64::to_degrees)
        })
    }

    #[test]
    fn angles_are_radians_with_east_positive_and_wrap_at_north() {
        for (given, expected) in [
            ((90.0, 2.0, 3.0), [92.0, 95.0, 2.0, 3.0]),
            ((90.0, -2.0, -3.0), [88.0, 85.0, -2.0, -3.0]),
            ((359.0, 2.0, -3.0), [1.0, 358.0, 2.0, -3.0]),
            ((1.0, -2.0, 3.0), [359.0, 2.0, -2.0, 3.0]),
        ] {
            let (compass, deviation, variation) = given;
            let read = values(&Heading::from_degrees(compass, deviation, variation));
            for (read, expected) in read.into_iter().zip(expected) {
                let read = read.unwrap();
                assert!(
                    (read - expected).abs() < 0.01,
                    "{given:?}: {read} {expected}"
                );
            }
        }
    }

    #[test]
    fn a_heading_that_is_withheld_is_null_and_the_variation_is_known_still() {
        let withheld = Heading {
            true_heading: None,
            ..Heading::from_degrees(90.0, 2.0, 3.0)
        };
        let [magnetic, of_true, deviation, variation] = values(&withheld);
        assert_eq!((magnetic, of_true, deviation), (None, None, None));
        assert!(variation.is_some());
    }
}
