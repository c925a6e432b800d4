//! The true values for judging a model.

use crate::poisson::Magnetism;
use crate::scenario::{Anomaly, Event, Scenario, Storm};
use crate::ship::{Ship, magnetism_at};
use binnacle_compass::angle::{wrap_180, wrap_360};
use binnacle_compass::time::Timestamp;
use serde::Serialize;

/// Interval between headings of the final table, degrees.
const STEP_DEG: u32 = 10;
const HOUR_S: f64 = 3600.0;

/// Records the truth of one ship's voyage.
#[derive(Clone, Debug)]
pub struct TruthRecorder {
    hours: Vec<Hour>,
    next_hour: Timestamp,
}

/// The truth of one ship's voyage.
#[derive(Clone, Debug, Serialize)]
pub struct Truth {
    scenario: String,
    seed: u64,
    vessel: String,
    from: Timestamp,
    until: Timestamp,
    alignment_deg: f64,
    gyro_constant_deg: f64,
    satellite_alignment_deg: Option<f64>,
    epochs: Vec<Epoch>,
    events: Vec<EventRecord>,
    hours: Vec<Hour>,
    at_the_end: Place,
}

/// An interval without an event, with the magnetism at its beginning.
#[derive(Clone, Debug, Serialize)]
struct Epoch {
    from: Timestamp,
    to: Option<Timestamp>,
    #[serde(flatten)]
    magnetism: Magnetism,
    lambda: f64,
    parameters_over_lambda: OverLambda,
}

/// The seven ratios that can be identified from headings.
#[derive(Clone, Copy, Debug, Serialize)]
struct OverLambda {
    bx_nt: f64,
    chi13: f64,
    by_nt: f64,
    chi23: f64,
    chi11_minus_chi22: f64,
    chi12: f64,
    chi21: f64,
}

#[derive(Clone, Debug, Serialize)]
struct EventRecord {
    kind: &'static str,
    from: Timestamp,
    to: Option<Timestamp>,
    detail: serde_json::Value,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Hour {
    time: Timestamp,
    lat: f64,
    lon: f64,
    alongside: bool,
    true_heading_deg: f64,
    variation_deg: f64,
    h_nt: f64,
    z_nt: f64,
    /// Compass reading without noise, and the deviation on it.
    compass_deg: f64,
    deviation_deg: f64,
}

/// The deviation curve at one place and time.
#[derive(Clone, Debug, Serialize)]
pub struct Place {
    /// Latitude, degrees north.
    pub lat: f64,
    /// Longitude, degrees east.
    pub lon: f64,
    /// Time.
    pub at: Timestamp,
    /// Charted variation, degrees east.
    pub variation_deg: f64,
    /// Charted horizontal field, nT.
    pub h_nt: f64,
    /// Charted vertical field, nT, positive down.
    pub z_nt: f64,
    /// The deviation every ten degrees of compass heading.
    pub rows: Vec<Row>,
}

/// The true deviation on one heading.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Row {
    /// Compass reading, degrees.
    pub compass_deg: f64,
    /// True heading less variation less compass reading, degrees east.
    pub deviation_deg: f64,
}

impl TruthRecorder {
    /// Creates an empty record of a voyage about to begin.
    pub fn new(ship: &Ship) -> TruthRecorder {
        TruthRecorder {
            hours: Vec::new(),
            next_hour: ship.start(),
        }
    }

    /// Records the ship's state when another hour has passed.
    pub fn record(&mut self, ship: &Ship) {
        if ship.time() < self.next_hour {
            return;
        }
        self.next_hour = self.next_hour.plus_seconds(HOUR_S);
        let field = ship.charted_field();
        let compass_deg = ship.quiet_compass_deg();
        let variation_deg = ship.charted_variation_deg();
        self.hours.push(Hour {
            time: ship.time(),
            lat: ship.position().lat_deg(),
            lon: ship.position().lon_deg(),
            alongside: ship.is_alongside(),
            true_heading_deg: ship.heading_deg(),
            variation_deg,
            h_nt: field.h_nt,
            z_nt: field.z_nt,
            compass_deg: wrap_360(compass_deg),
            deviation_deg: wrap_180(ship.heading_deg() - variation_deg - compass_deg),
        });
    }

    /// Returns the truth so far.
    pub fn truth(&self, scenario: &Scenario, seed: u64, ship: &Ship) -> Truth {
        let plan = ship.plan();
        Truth {
            scenario: scenario.name.clone(),
            seed,
            vessel: plan.name.clone(),
            from: ship.start(),
            until: ship.time(),
            alignment_deg: plan.alignment_deg,
            gyro_constant_deg: plan.gyro.constant_deg,
            satellite_alignment_deg: plan.satellite.map(|satellite| satellite.alignment_deg),
            epochs: epochs(ship),
            events: event_records(scenario, ship),
            hours: self.hours.clone(),
            at_the_end: place(ship),
        }
    }
}

/// Returns the true deviation on all headings at the ship's present place.
pub fn place(ship: &Ship) -> Place {
    let field = ship.charted_field();
    Place {
        lat: ship.position().lat_deg(),
        lon: ship.position().lon_deg(),
        at: ship.time(),
        variation_deg: ship.charted_variation_deg(),
        h_nt: field.h_nt,
        z_nt: field.z_nt,
        rows: (0..360 / STEP_DEG)
            .map(|step| {
                let compass_deg = f64::from(step * STEP_DEG);
                Row {
                    compass_deg,
                    deviation_deg: ship.deviation_deg(compass_deg),
                }
            })
            .collect(),
    }
}

fn epochs(ship: &Ship) -> Vec<Epoch> {
    let plan = ship.plan();
    let sailed_days = ship.time().seconds_since(ship.start()) / 86_400.0;
    let mut days = vec![0.0];
    for event in &plan.events {
        match event {
            Event::Lightning { day, .. } => days.push(*day),
            Event::Cargo {
                from_day, to_day, ..
            } => days.extend([*from_day, *to_day]),
            Event::GyroFault { .. } => {}
        }
    }
    days.retain(|day| *day <= sailed_days);
    days.sort_by(f64::total_cmp);
    days.dedup();
    let at = |day: f64| ship.start().plus_seconds(day * 86_400.0);
    days.iter()
        .enumerate()
        .map(|(index, &day)| {
            let magnetism = magnetism_at(plan, day);
            Epoch {
                from: at(day),
                to: days.get(index + 1).map(|&next| at(next)),
                magnetism,
                lambda: magnetism.lambda(),
                parameters_over_lambda: over_lambda(&magnetism),
            }
        })
        .collect()
}

fn over_lambda(magnetism: &Magnetism) -> OverLambda {
    let lambda = magnetism.lambda();
    let [[xx, xy, xz], [yx, yy, yz], _] = magnetism.chi;
    OverLambda {
        bx_nt: magnetism.b_nt[0] / lambda,
        chi13: xz / lambda,
        by_nt: magnetism.b_nt[1] / lambda,
        chi23: yz / lambda,
        chi11_minus_chi22: (xx - yy) / lambda,
        chi12: xy / lambda,
        chi21: yx / lambda,
    }
}

fn event_records(scenario: &Scenario, ship: &Ship) -> Vec<EventRecord> {
    let at = |day: f64| ship.start().plus_seconds(day * 86_400.0);
    let own = ship.plan().events.iter().map(|event| match event {
        Event::Lightning {
            day,
            b_nt,
            returning,
            return_days,
        } => EventRecord {
            kind: "lightning",
            from: at(*day),
            to: None,
            detail: serde_json::json!({
                "b_nt": b_nt, "returning": returning, "return_days": return_days
            }),
        },
        Event::Cargo {
            from_day,
            to_day,
            magnetism,
        } => EventRecord {
            kind: "cargo",
            from: at(*from_day),
            to: Some(at(*to_day)),
            detail: serde_json::json!({ "b_nt": magnetism.b_nt, "chi": magnetism.chi }),
        },
        Event::GyroFault {
            from_day,
            to_day,
            offset_deg,
            drift_deg_per_h,
        } => EventRecord {
            kind: "gyro_fault",
            from: at(*from_day),
            to: Some(at(*to_day)),
            detail: serde_json::json!({
                "offset_deg": offset_deg, "drift_deg_per_h": drift_deg_per_h
            }),
        },
    });
    let storm = |storm: &Storm| EventRecord {
        kind: "storm",
        from: at(storm.day),
        to: Some(at(storm.day + storm.hours / 24.0)),
        detail: serde_json::json!({ "strength_nt": storm.strength_nt }),
    };
    let anomaly = |anomaly: &Anomaly| EventRecord {
        kind: "anomaly",
        from: ship.start(),
        to: None,
        detail: serde_json::json!({
            "name": anomaly.name, "lat": anomaly.position.lat_deg(),
            "lon": anomaly.position.lon_deg(), "radius_nm": anomaly.radius_nm,
            "field_nt": anomaly.field_nt
        }),
    };
    own.chain(scenario.storms.iter().map(storm))
        .chain(scenario.anomalies.iter().map(anomaly))
        .collect()
}
