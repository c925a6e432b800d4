//! Benchmarks of a fit: sixty days, and a year and more, of ten-minute samples.

#![allow(missing_docs)] // divan's attribute makes public items
#![allow(clippy::unwrap_used)] // as the voyages that it sails

#[path = "../tests/voyages/mod.rs"]
#[allow(dead_code)]
mod voyages;

use binnacle_analysis::fit::{RobustOptions, fit_robust};
use divan::Bencher;
use voyages::{Faults, Variety, sail};

fn main() {
    divan::main();
}

/// 60 days are some 7,500 samples; 423 days some 52,000.
#[divan::bench(args = [60, 423], sample_count = 10, sample_size = 1)]
fn robust_fit(bencher: Bencher<'_, '_>, days: u32) {
    let voyage = sail(3, Variety::Medium, f64::from(days), &Faults::USUAL);
    bencher.bench_local(|| fit_robust(&voyage.observations, &RobustOptions::default()));
}
