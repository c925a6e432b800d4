//! How long a batch takes, each way.

#[path = "../tests/support/mod.rs"]
mod support;

use binnacle_wire::{decode, encode};
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

/// A quarter of a day, three days, three weeks.
const SIZES: [usize; 3] = [29, 360, 3000];

#[divan::bench(args = SIZES)]
fn encode_batch(bencher: Bencher<'_, '_>, samples: usize) {
    let batch = support::batch(7, support::voyage(1, samples));
    bencher
        .counter(ItemsCount::new(samples))
        .bench(|| encode(divan::black_box(&batch)));
}

#[divan::bench(args = SIZES)]
fn decode_batch(bencher: Bencher<'_, '_>, samples: usize) {
    let bytes = encode(&support::batch(7, support::voyage(1, samples))).expect("a sane voyage");
    bencher
        .counter(ItemsCount::new(samples))
        .bench(|| decode(divan::black_box(&bytes)));
}
