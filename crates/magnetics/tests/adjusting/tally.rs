//! Plans held against the truth.

#![allow(clippy::unwrap_used)] // a study

use super::adjusting::knowledge::{Instruments, model, reading, waters};
use super::adjusting::random::Random;
use super::adjusting::{binnacle, ship};
use binnacle_magnetics::adjust::{Adjustment, Circumstances, Limits, plan};
use std::collections::BTreeMap;
use std::fmt;

/// What became of many ships.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) ships: u64,
    pub(crate) planned: u64,
    /// Refusals by their first words.
    pub(crate) refused: BTreeMap<String, u64>,
    pub(crate) headings: u64,
    pub(crate) held: u64,
    /// Worst true residual of each plan, degrees.
    pub(crate) worst_deg: Vec<f64>,
    pub(crate) before_deg: Vec<f64>,
    pub(crate) band_deg: Vec<f64>,
    pub(crate) moves: Vec<f64>,
    pub(crate) nodes: Vec<f64>,
    pub(crate) unproven: u64,
}

impl Tally {
    pub(crate) fn of(seeds: std::ops::Range<u64>, which: usize, instruments: Instruments) -> Tally {
        let mut tally = Tally::default();
        for seed in seeds {
            tally.add(seed, which, instruments);
        }
        tally
    }

    fn add(&mut self, seed: u64, which: usize, instruments: Instruments) {
        self.ships += 1;
        let mut rng = Random::new(seed);
        let binnacle = binnacle(&mut rng, which);
        let truth = ship(&mut rng, &binnacle);
        // Small binnacles, which have no Flinders bar, keep to one sea.
        let waters = waters(&mut rng, if which == 0 { 1.0 } else { 0.15 });
        let standing = truth.with(&binnacle.setting);
        let model = model(&mut rng, &standing, &waters);
        let berth = waters[0].earth();
        let place = (berth.h_nt, berth.z_nt);
        let reading = reading(&mut rng, &standing, place, instruments);
        let outcome = plan(&Adjustment {
            model: &model,
            earth: berth,
            reading: &reading,
            scale_sd: instruments.scale_sd,
            compass_deg: None,
            vertical: None,
            binnacle: &binnacle,
            now: None,
            waters: &waters,
            circumstances: Circumstances::default(),
            limits: Limits::default(),
        })
        .unwrap();
        if let Some(refused) = outcome.refusals.first() {
            let why = serde_json::to_value(&refused.refusal).unwrap();
            *self.refused.entry(why["refusal"].to_string()).or_default() += 1;
            return;
        }
        let best = &outcome.plans[0];
        self.planned += 1;
        self.moves.push(f64::from(best.moves));
        let optimality = outcome.optimality.unwrap();
        self.nodes.push(optimality.nodes as f64);
        self.unproven += u64::from(!optimality.proven);
        self.before_deg.push(standing.worst_deg(place));
        let mut worst: f64 = 0.0;
        let adjusted = truth.with(&best.setting);
        for table in &best.after {
            let place = (table.h_nt, table.z_nt);
            worst = worst.max(adjusted.worst_deg(place));
            self.band_deg.push(table.widest_band_deg.unwrap());
            for row in &table.rows {
                let residual = adjusted.deviation_deg(place, row.compass_deg);
                self.headings += 1;
                let off = super::adjusting::wrap(residual - row.deviation_deg);
                self.held += u64::from(off.abs() <= row.band95_deg.unwrap());
            }
        }
        self.worst_deg.push(worst);
    }

    /// Share of headings on which the band held.
    pub(crate) fn coverage(&self) -> f64 {
        self.held as f64 / self.headings as f64
    }

    /// Share of plans whose worst true residual is 3° at most.
    pub(crate) fn within_3_deg(&self) -> f64 {
        let within = self.worst_deg.iter().filter(|worst| **worst <= 3.0);
        within.count() as f64 / self.worst_deg.len() as f64
    }
}

fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let index = (share * (sorted.len() as f64 - 1.0)).round() as usize;
    sorted.get(index).copied().unwrap_or(f64::NAN)
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let two = |values: &[f64]| {
            format!(
                "{:.2} / {:.2}",
                quantile(values, 0.5),
                quantile(values, 0.95)
            )
        };
        write!(
            f,
            "{} ships, {} planned, refused {:?}; band held {:.1} %; worst true residual \
             median / 95 % {} (before {}), within 3 degrees {:.1} %; band {}; moves {}; nodes {}; \
             not proven {}",
            self.ships,
            self.planned,
            self.refused,
            100.0 * self.coverage(),
            two(&self.worst_deg),
            two(&self.before_deg),
            100.0 * self.within_3_deg(),
            two(&self.band_deg),
            two(&self.moves),
            two(&self.nodes),
            self.unproven,
        )
    }
}
