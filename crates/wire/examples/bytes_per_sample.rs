//! Bytes per sample on the link, by size of the batch.
//!
//! `cargo run -p binnacle-wire --example bytes_per_sample`

#[path = "../tests/support/mod.rs"]
mod support;

use binnacle_compass::sample::Sample;
use binnacle_wire::encode;

fn main() {
    println!("samples a batch   bytes a batch   bytes a sample   with course, roll and all");
    for samples in [1, 10, 29, 60, 114, 144, 360, 3000] {
        let bytes = bytes_a_batch(samples, support::voyage);
        let all = bytes_a_batch(samples, support::voyage_with_motion);
        let a_sample = bytes / samples as f64;
        println!("{samples:15}{bytes:16.1}{a_sample:17.2}{all:27.1}");
    }
}

/// Returns the mean over twenty voyages.
fn bytes_a_batch(samples: usize, sail: fn(u64, usize) -> Vec<Sample>) -> f64 {
    let total: usize = (0..20)
        .map(|seed| support::batch(7, sail(seed, samples)))
        .map(|batch| encode(&batch).expect("a sane voyage").len())
        .sum();
    total as f64 / 20.0
}
