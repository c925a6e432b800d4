//! Time to encode and decode a batch.

#[path = "../tests/support/mod.rs"]
mod support;

use binnacle_wire::codec::MAX_BYTES;
use binnacle_wire::{decode, encode};
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

/// Samples of a quarter of a day, three days and three weeks.
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

/// The costliest frame for a decoder: 64 columns of 65,535 equal samples.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn refuse_costliest(bencher: Bencher<'_, '_>) {
    let mut frame = b"BN\x01\x02".to_vec();
    frame.extend([0x11; 16]);
    // seq 1, no tally, 65,535 samples, 64 columns.
    frame.extend([1, 0, 0xff, 0xff, 3, 64]);
    frame.extend((1..=64).flat_map(|id| [id, 0x10]));
    frame.resize(MAX_BYTES - 4, 0);
    frame.extend(crc32fast::hash(&frame).to_le_bytes());
    bencher.bench(|| decode(divan::black_box(&frame)).is_err());
}
