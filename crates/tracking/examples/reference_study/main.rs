//! Study of the references that are refused: rates over simulated ships of true headings made
//! of the compass, and of independent instruments that must pass.
//!
//! `cargo run --release -p binnacle-tracking --example reference_study -- SHIPS`. Every ship is
//! read once a second; her settled samples are those of a validation. "Rows" are checked as
//! `fit` checks a recording of every second, "samples" as `analyse` checks settled ones.

#![allow(clippy::unwrap_used)] // a study, run by hand

mod kinds;
mod ship;

use binnacle_analysis::fit::{HeadingPair, check_independence, weigh_independence};
use binnacle_compass::field::{FieldAt, FieldModel};
use binnacle_compass::sample::Sample;
use binnacle_tracking::validation::settle;
use kinds::KINDS;
use ship::{Ship, WEATHERS};

fn main() {
    let ships = std::env::args().nth(1).and_then(|n| n.parse().ok());
    let ships: u64 = ships.unwrap_or(20);
    println!(
        "refused of {ships} ships by rows and by settled samples, with the mean log-likelihood ratio row by row"
    );
    for weather in &WEATHERS {
        for kind in &KINDS {
            let (mut rows, mut samples) = (Tally::default(), Tally::default());
            for seed in 0..ships {
                let read = Ship::new(seed, weather).sail(kind);
                rows.add(&pairs(&read));
                samples.add(&pairs(&settle(&read).samples));
            }
            println!(
                "{:<10} {:<34} rows {}  samples {}",
                weather.name, kind.name, rows, samples
            );
        }
    }
}

fn pairs(samples: &[Sample]) -> Vec<HeadingPair> {
    let middle = samples[samples.len() / 2].time;
    let field = FieldAt::from_time(FieldModel::Igrf14, middle).unwrap();
    let of = |sample: &Sample| {
        Some(HeadingPair {
            time: Some(sample.time),
            position: Some(sample.position),
            compass: sample.compass,
            reference: sample.satellite?,
            variation: field.at(sample.position, 0.0).unwrap().declination(),
            sog_kn: sample.sog_kn,
        })
    };
    samples.iter().filter_map(of).collect()
}

#[derive(Default)]
struct Tally {
    ships: u64,
    refused: u64,
    weighed: u64,
    log_ratios: f64,
}

impl Tally {
    fn add(&mut self, pairs: &[HeadingPair]) {
        self.ships += 1;
        self.refused += u64::from(check_independence(pairs).is_err());
        if let Some(evidence) = weigh_independence(pairs) {
            self.weighed += 1;
            self.log_ratios += evidence.log_ratio();
        }
    }
}

impl std::fmt::Display for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mean = self.log_ratios / self.weighed.max(1) as f64;
        write!(f, "{:>3}/{:<3} ({mean:>7.1})", self.refused, self.ships)
    }
}
