//! Plans compared with the truth.

#![allow(clippy::unwrap_used)] // a study

use super::adjusting::knowledge::Instruments;
use super::adjusting::random::Random;
use super::adjusting::scene::{Hidden, Scene};
use super::adjusting::{Standing, wrap};
use binnacle_adjustment::adjust::plan;
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use std::collections::BTreeMap;
use std::fmt;

/// Statistics of many ships.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) ships: u64,
    pub(crate) planned: u64,
    /// Number of refusals by kind.
    pub(crate) refused: BTreeMap<String, u64>,
    /// Coverage of each plan's band over headings.
    pub(crate) held: Vec<f64>,
    /// Mean half-width of the band, of each plan, degrees.
    pub(crate) half_width_deg: Vec<f64>,
    /// Worst true residual of each plan, degrees.
    pub(crate) worst_deg: Vec<f64>,
    /// Coverage in other waters than the plan's, and the error there, root mean square, degrees.
    pub(crate) held_elsewhere: Vec<f64>,
    pub(crate) off_elsewhere_deg: Vec<f64>,
    /// Both of the model after without the needles' part.
    pub(crate) held_elsewhere_without_needles: Vec<f64>,
    pub(crate) off_elsewhere_without_needles_deg: Vec<f64>,
    /// Plans whose worst true residual in any of its waters exceeds the stated one with its band.
    pub(crate) outside: u64,
    pub(crate) before_deg: Vec<f64>,
    /// Heeling error at the berth before, after, and predicted less true, degrees per
    /// degree.
    pub(crate) heel_before: Vec<f64>,
    pub(crate) heel_after: Vec<f64>,
    pub(crate) heel_off: Vec<f64>,
    pub(crate) moves: Vec<f64>,
    pub(crate) nodes: Vec<f64>,
    pub(crate) unproven: u64,
}

impl Tally {
    pub(crate) fn from_seeds(
        seeds: std::ops::Range<u64>,
        which: usize,
        instruments: Instruments,
    ) -> Tally {
        let mut tally = Tally::default();
        for seed in seeds {
            tally.add(&Scene::new(seed, which, instruments));
        }
        tally
    }

    /// Ships of which the planner does not know everything.
    pub(crate) fn hidden(
        seeds: std::ops::Range<u64>,
        which: usize,
        instruments: Instruments,
        hidden: Hidden,
    ) -> Tally {
        let mut tally = Tally::default();
        for seed in seeds {
            tally.add(&Scene::with(seed, which, instruments, hidden));
        }
        tally
    }

    /// Ships whose permanent field changed since the model, along and across the needle, by
    /// the tangents of these angles times the measured field; with or without an earlier λ.
    pub(crate) fn changed(
        seeds: std::ops::Range<u64>,
        [along_deg, across_deg]: [std::ops::Range<f64>; 2],
        instruments: Instruments,
        said: Instruments,
        earlier_lambda_sd: Option<f64>,
    ) -> Tally {
        let mut tally = Tally::default();
        for seed in seeds {
            let mut scene = Scene::new(seed, 0, instruments);
            let mut size = |of: &std::ops::Range<f64>| {
                let sign = if scene.rng.unit() < 0.5 { -1.0 } else { 1.0 };
                sign * scene.rng.between(of.start, of.end).to_radians().tan()
            };
            let [x, y] = scene.berthed.reading.field_nt();
            let change = [size(&along_deg), size(&across_deg)].map(|share| share * x.hypot(y));
            if let Some(error) = earlier_lambda_sd {
                scene.add_earlier_lambda(error);
            }
            tally.add(&scene.changed(change, instruments, said));
        }
        tally
    }

    fn add(&mut self, scene: &Scene) {
        self.ships += 1;
        let outcome = plan(&scene.adjustment()).unwrap();
        if let Some(refused) = outcome.refusals.first() {
            let why = serde_json::to_value(&refused.refusal).unwrap();
            let why = why["refusal"].as_str().unwrap().to_owned();
            *self.refused.entry(why).or_default() += 1;
            return;
        }
        let best = &outcome.plans[0];
        self.planned += 1;
        self.moves.push(f64::from(best.moves));
        let optimality = outcome.optimality.unwrap();
        self.nodes.push(optimality.nodes as f64);
        self.unproven += u64::from(!optimality.proven);
        let berth = scene.place();
        self.before_deg.push(scene.standing.worst_deg(berth));
        let adjusted = scene.truth.with(&scene.truly(&best.setting));
        let (mut worst, mut held, mut widths, mut headings) = (0.0_f64, 0_u32, 0.0, 0_u32);
        let mut is_outside = false;
        for table in &best.after {
            let place = (table.h_nt, table.z_nt);
            let worst_here = adjusted.worst_deg(place);
            is_outside |= table.reach_deg.is_none_or(|reach| worst_here > reach);
            worst = worst.max(worst_here);
            for row in &table.rows {
                let residual = adjusted.deviation_deg(place, row.compass_deg);
                let band = row.band95_deg.unwrap();
                headings += 1;
                held += u32::from(wrap(residual - row.deviation_deg).abs() <= band);
                widths += band;
            }
        }
        self.worst_deg.push(worst);
        self.outside += u64::from(is_outside);
        self.held.push(f64::from(held) / f64::from(headings));
        self.half_width_deg.push(widths / f64::from(headings));
        let forgetful = Model {
            needles: None,
            ..best.model_after.clone()
        };
        let (held, off_deg) = in_other_waters(scene, &adjusted, &best.model_after);
        self.held_elsewhere.push(held);
        self.off_elsewhere_deg.push(off_deg);
        let (held, off_deg) = in_other_waters(scene, &adjusted, &forgetful);
        self.held_elsewhere_without_needles.push(held);
        self.off_elsewhere_without_needles_deg.push(off_deg);
        let after = adjusted.heeling_error(berth);
        let predicted = best.heeling.after_deg_per_deg.unwrap();
        let before = scene.standing.heeling_error(berth);
        self.heel_before.push(before.abs());
        self.heel_after.push(after.abs());
        self.heel_off.push((predicted - after).abs());
    }

    /// Mean coverage of the band over headings.
    pub(crate) fn coverage(&self) -> f64 {
        mean(&self.held)
    }

    /// Standard error of the coverage: headings of one plan have common errors.
    pub(crate) fn coverage_sd(&self) -> f64 {
        let average = self.coverage();
        let squares: f64 = self.held.iter().map(|held| (held - average).powi(2)).sum();
        squares.sqrt() / self.held.len() as f64
    }

    /// Share of plans whose worst true residual is at most 3°.
    pub(crate) fn within_3_deg(&self) -> f64 {
        let within = self.worst_deg.iter().filter(|worst| **worst <= 3.0);
        within.count() as f64 / self.worst_deg.len() as f64
    }
}

/// Number of other waters for each ship.
const OTHER_WATERS: usize = 4;

/// Compares a model with the truth in other waters than the plan's: coverage of the band, and
/// root mean square of the error, degrees.
fn in_other_waters(scene: &Scene, adjusted: &Standing, model: &Model) -> (f64, f64) {
    let mut rng = Random::new(scene.seed ^ 0xfa7);
    let (mut held, mut squares, mut headings) = (0_u32, 0.0, 0_u32);
    for _ in 0..OTHER_WATERS {
        let earth = EarthField {
            h_nt: rng.between(15_000.0, 39_000.0),
            z_nt: rng.between(-30_000.0, 50_000.0),
        };
        for step in 0..24 {
            let compass = CompassHeading::new(15.0 * f64::from(step)).unwrap();
            let Ok(predicted) = model.deviation(compass, earth) else {
                continue;
            };
            let truth = adjusted.deviation_deg((earth.h_nt, earth.z_nt), compass.degrees());
            let off_deg = wrap(truth - predicted.deviation.degrees_east());
            held += u32::from(off_deg.abs() <= predicted.band95_deg.unwrap());
            squares += off_deg.powi(2);
            headings += 1;
        }
    }
    let headings = f64::from(headings.max(1));
    (f64::from(held) / headings, (squares / headings).sqrt())
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

pub(crate) fn quantile(values: &[f64], share: f64) -> f64 {
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
            "{} ships, {} planned, refused {:?}; worst beyond the stated {}; band held {:.1} % \
             (standard error {:.1}), mean half-width {:.2}; in other waters {:.1} %, off {:.2} \
             (without needles {:.1} %, off {:.2}); worst true residual median / 95 % {} (before {}), within 3 degrees \
             {:.1} %; heeling error median / 95 % {} (before {}), off the prediction {}; \
             moves {}; nodes {}; not proven {}",
            self.ships,
            self.planned,
            self.refused,
            self.outside,
            100.0 * self.coverage(),
            100.0 * self.coverage_sd(),
            mean(&self.half_width_deg),
            100.0 * mean(&self.held_elsewhere),
            mean(&self.off_elsewhere_deg),
            100.0 * mean(&self.held_elsewhere_without_needles),
            mean(&self.off_elsewhere_without_needles_deg),
            two(&self.worst_deg),
            two(&self.before_deg),
            100.0 * self.within_3_deg(),
            two(&self.heel_after),
            two(&self.heel_before),
            two(&self.heel_off),
            two(&self.moves),
            two(&self.nodes),
            self.unproven,
        )
    }
}
