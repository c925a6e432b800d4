//! Bytes per sample on the link, by size of the batch.
//!
//! `cargo run -p binnacle-wire --example bytes_per_sample`

#[path = "../tests/support/mod.rs"]
mod support;

use binnacle_wire::encode;

fn main() {
    println!("samples a batch   bytes a batch   bytes a sample");
    for samples in [1, 10, 29, 60, 114, 144, 360, 3000] {
        let total: usize = (0..20)
            .map(|seed| support::batch(7, support::voyage(seed, samples)))
            .map(|batch| encode(&batch).expect("a sane voyage").len())
            .sum();
        let bytes = total as f64 / 20.0;
        println!("{samples:15}{bytes:16.1}{:17.2}", bytes / samples as f64);
    }
}
