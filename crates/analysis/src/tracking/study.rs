//! Temporary: what a study asks.
use crate::fit::Observation;
use crate::tracking::state_space::levels::Level;
use crate::tracking::state_space::row::Placed;
use crate::tracking::tracker::tracker::Tracker;
use binnacle_compass::field::{FieldAt, FieldModel};
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;

/// Runs.
#[allow(missing_docs)]
pub struct Run {
    pub lines: Vec<String>,
    pub z: Vec<(f64, f64, f64)>,
    pub rows: usize,
    pub bank_mean: f64,
    pub replays: usize,
    pub mean: [f64; 30],
    pub sd: [f64; 30],
    pub levels: Vec<(String, f64)>,
    /// Times at which the lead came to suppose another list of events.
    pub told: Vec<(String, Timestamp, Timestamp, Option<Timestamp>)>,
    pub leads: Vec<(Timestamp, Vec<String>)>,
}

#[allow(missing_docs)]
pub fn run(samples: &[Sample]) -> Run {
    let mut tracker = Tracker::new(0.5);
    let mut day = i64::MIN;
    let mut field = None;
    let mut z = Vec::new();
    let mut rows = 0;
    let mut bank = 0;
    let mut leads: Vec<(Timestamp, Vec<String>)> = Vec::new();
    for sample in samples {
        let d = sample.time.micros().div_euclid(86_400_000_000);
        if d != day {
            day = d;
            let noon = Timestamp::from_micros(d * 86_400_000_000 + 43_200_000_000).unwrap();
            field = FieldAt::from_time(FieldModel::Igrf14, noon).ok();
        }
        let Some(here) = field.as_ref().and_then(|f| f.at(sample.position, 0.0).ok()) else {
            continue;
        };
        let placed = Placed {
            sample,
            gyro: sample.gyro,
            variation: here.declination(),
            earth: here.for_ship(),
        };
        let Some(t) = tracker.read(&placed) else {
            continue;
        };
        rows += 1;
        bank += tracker.bank.len();
        z.push((
            t.read.deviation.value,
            t.read.deviation.variance,
            t.read.difference.map_or(0.0, |d| d.z_squared()),
        ));
        if std::env::var("AT").is_ok_and(|at| sample.time.to_string().starts_with(&at)) {
            let best = tracker
                .bank
                .iter()
                .map(|h| h.log_weight())
                .fold(f64::NEG_INFINITY, f64::max);
            eprintln!(
                "{} v {:.2} sd {:.2} hdg {:.0}",
                sample.time,
                t.read.deviation.value,
                t.read.deviation.variance.sqrt(),
                sample.compass.degrees()
            );
            for h in tracker.bank.iter().take(8) {
                let ev: Vec<String> = h
                    .events
                    .iter()
                    .rev()
                    .take(3)
                    .map(|e| {
                        format!(
                            "{:?} {} {}",
                            e.kind,
                            &e.from.to_string()[5..16],
                            e.until
                                .map_or(String::new(), |u| u.to_string()[5..16].to_string())
                        )
                    })
                    .collect();
                eprintln!(
                    "      {:.1} prior {:.1} {}",
                    h.log_weight() - best,
                    h.log_prior,
                    ev.join(" | ")
                );
            }
        }
        let events: Vec<String> = tracker.bank[0]
            .events
            .iter()
            .map(|e| {
                format!(
                    "{:?} {}{}",
                    e.kind,
                    e.from,
                    e.until.map_or(String::new(), |u| format!(" until {u}"))
                )
            })
            .collect();
        if leads.last().is_none_or(|(_, last)| *last != events) {
            leads.push((sample.time, events));
        }
    }
    let f = &tracker.bank[0].filter;
    let _: Option<Observation> = None;
    Run {
        lines: tracker
            .bank
            .iter()
            .map(|h| {
                format!(
                    "{:.1} {:?} start {}",
                    h.log_weight() - tracker.bank[0].log_weight(),
                    h.events
                        .iter()
                        .map(|e| (e.kind, e.from.to_string(), e.until.map(|u| u.to_string())))
                        .collect::<Vec<_>>(),
                    h.start
                )
            })
            .collect(),
        z,
        rows,
        bank_mean: bank as f64 / rows as f64,
        replays: tracker.replays,
        mean: f.mean,
        sd: std::array::from_fn(|i| f.covariance[i][i].max(0.0).sqrt()),
        levels: Level::ALL
            .iter()
            .map(|l| (format!("{l:?}"), tracker.levels().at(*l)))
            .collect(),
        told: tracker
            .told
            .iter()
            .map(|t| {
                (
                    format!("{:?} {:?}", t.class, t.event.kind),
                    t.event.from,
                    t.at,
                    t.withdrawn,
                )
            })
            .collect(),
        leads,
    }
}
