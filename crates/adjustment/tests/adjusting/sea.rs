//! Headings at sea after correct and incorrect adjustments.

#![allow(clippy::unwrap_used)] // a study

use super::adjusting::knowledge::FLUXGATE;
use super::adjusting::scene::Scene;
use super::tally::quantile;
use binnacle_adjustment::adjust::{Plan, SettledHeading, Verification, plan, verify};
use binnacle_compass::angle::CompassHeading;
use std::fmt;

/// Standard deviation of a heading at sea, degrees.
const HEADING_SD_DEG: f64 = 0.7;
/// Greatest number of headings.
const MOST_HEADINGS: usize = 60;

/// Statistics of many adjustments.
#[derive(Default)]
pub(crate) struct Sea {
    /// Headings until a pass.
    pub(crate) passed: Vec<f64>,
    /// Headings until an alarm.
    pub(crate) alarmed: Vec<f64>,
    pub(crate) undecided: u64,
    /// Passed adjustments with more than this difference from the prediction on any
    /// heading.
    pub(crate) passed_beyond_2_deg: u64,
}

impl Sea {
    /// Ships with these errors of permanent magnetism in the plan, on the worst heading at
    /// the berth, degrees: one tally for each.
    pub(crate) fn from_seeds(seeds: std::ops::Range<u64>, wrong_deg: &[f64]) -> Vec<Sea> {
        let mut seas: Vec<Sea> = wrong_deg.iter().map(|_| Sea::default()).collect();
        for seed in seeds {
            let mut scene = Scene::new(seed, 0, FLUXGATE);
            let outcome = plan(&scene.adjustment()).unwrap();
            let Some(best) = outcome.plans.first() else {
                continue;
            };
            let right_nt = scene.truth.bare_b_nt;
            for (sea, wrong_deg) in seas.iter_mut().zip(wrong_deg) {
                scene.truth.bare_b_nt = right_nt;
                sea.add(&mut scene, best, *wrong_deg);
            }
        }
        seas
    }

    fn add(&mut self, scene: &mut Scene, best: &Plan, wrong_deg: f64) {
        let place = scene.place();
        let towards = scene.rng.between(0.0, std::f64::consts::TAU);
        let size_nt = wrong_deg.to_radians() * best.lambda * place.0;
        scene.truth.bare_b_nt[0] += size_nt * towards.cos();
        scene.truth.bare_b_nt[1] += size_nt * towards.sin();
        let adjusted = scene.truth.with(&best.setting);
        let earth = scene.waters[0].earth();
        let mut settled: Vec<SettledHeading> = Vec::new();
        loop {
            let needed = match verify(&best.model_after, &settled, earth).unwrap() {
                Verification::Passed { headings, .. } => {
                    self.passed.push(headings as f64);
                    let off = best.after[0].rows.iter().map(|row| {
                        let truth = adjusted.deviation_deg(place, row.compass_deg);
                        (truth - row.deviation_deg).abs()
                    });
                    self.passed_beyond_2_deg += u64::from(off.fold(0.0, f64::max) > 2.0);
                    return;
                }
                Verification::Alarm { .. } => {
                    self.alarmed.push(settled.len() as f64);
                    return;
                }
                Verification::MoreNeeded { needed, .. } => needed,
            };
            if settled.len() == MOST_HEADINGS || needed.compass_deg.is_empty() {
                self.undecided += 1;
                return;
            }
            // Any heading within the requested sector suffices.
            let within = scene.rng.between(-7.0, 7.0);
            let compass = CompassHeading::new(needed.compass_deg[0] + within).unwrap();
            let truth = adjusted.deviation_deg(place, compass.degrees());
            let error = scene.reference_deg + HEADING_SD_DEG * scene.rng.gaussian();
            settled.push(SettledHeading {
                compass,
                deviation_deg: truth + error,
                sd_deg: HEADING_SD_DEG,
                earth,
            });
        }
    }

    /// Number of adjustments.
    pub(crate) fn ships(&self) -> f64 {
        self.passed.len() as f64 + self.alarmed.len() as f64 + self.undecided as f64
    }
}

impl fmt::Display for Sea {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = |count: usize| 100.0 * count as f64 / self.ships();
        write!(
            f,
            "{} ships: {:.1} % passed after {} headings (median; 95 % {}), {} of them beyond 2 \
             degrees somewhere; {:.1} % alarmed after {} (95 % {}); {} undecided",
            self.ships(),
            share(self.passed.len()),
            quantile(&self.passed, 0.5),
            quantile(&self.passed, 0.95),
            self.passed_beyond_2_deg,
            share(self.alarmed.len()),
            quantile(&self.alarmed, 0.5),
            quantile(&self.alarmed, 0.95),
            self.undecided,
        )
    }
}
