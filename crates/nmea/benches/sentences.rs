//! Time per sentence, read and written. The agent reads some thirteen million
//! of them when a recorded year is replayed.

use binnacle_nmea::{Lines, Sentence, Tally, lines::Line, parse, write};
use divan::Bencher;
use divan::counter::{BytesCount, ItemsCount};

const SENTENCES: [&str; 6] = [
    "$HCHDG,98.3,0.0,E,12.6,W*57",
    "$HEHDT,274.07,T*19",
    "$HEROT,-1.5,A*02",
    "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A",
    "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47",
    "$GPVTG,054.7,T,034.4,M,005.5,N,010.2,K*48",
];

fn main() {
    divan::main();
}

#[divan::bench(args = SENTENCES)]
fn read(bencher: Bencher<'_, '_>, sentence: &str) {
    bencher.bench(|| parse(divan::black_box(sentence.as_bytes())).expect("it is a sound sentence"));
}

#[divan::bench(args = SENTENCES)]
fn print(bencher: Bencher<'_, '_>, sentence: &str) {
    let sentence: Sentence = parse(sentence.as_bytes()).expect("it is a sound sentence");
    let mut out = Vec::with_capacity(256);
    bencher.bench_local(|| {
        out.clear();
        write(divan::black_box(&sentence), &mut out);
        out.len()
    });
}

/// A stream in chunks of 16 kB, cut, read and counted.
#[divan::bench]
fn stream(bencher: Bencher<'_, '_>) {
    let stream = (SENTENCES.join("\r\n") + "\r\n").repeat(1000);
    bencher
        .counter(BytesCount::of_str(&stream))
        .counter(ItemsCount::new(6000_usize))
        .bench(|| {
            let (mut lines, mut tally) = (Lines::default(), Tally::default());
            for chunk in stream.as_bytes().chunks(16_384) {
                lines.push(chunk, |line| {
                    if let Line::Whole(line) = line {
                        divan::black_box(tally.read(line));
                    }
                });
            }
            assert_eq!(tally.total_read(), 6000);
        });
}
