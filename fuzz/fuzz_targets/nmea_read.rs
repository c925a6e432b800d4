//! Any bytes: nothing panics, memory stays bounded, and every sentence read is
//! printed so that it reads back the same. The checksum is put right too;
//! otherwise the fuzzer would hardly ever get past it.
#![no_main]

use binnacle_nmea::lines::{Line, MAX_LINE_BYTES};
use binnacle_nmea::{Lines, Rejected, Tally, datagram, parse, write};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    print_and_read_again(bytes);
    let sum = bytes.iter().fold(0, |sum, byte| sum ^ byte);
    print_and_read_again(&[b"$", bytes, format!("*{sum:02X}").as_bytes()].concat());

    let mut whole = Tally::default();
    cut(bytes, bytes.len().max(1), &mut whole);
    let mut pieces = Tally::default();
    cut(bytes, 7, &mut pieces);
    assert_eq!(whole, pieces);

    if let Ok(lines) = datagram::lines(bytes) {
        for line in lines {
            whole.read(line);
        }
    }
});

fn print_and_read_again(line: &[u8]) {
    let Ok(sentence) = parse(line) else { return };
    let mut printed = Vec::new();
    write(&sentence, &mut printed);
    assert_eq!(parse(&printed), Ok(sentence), "{}", printed.escape_ascii());
}

fn cut(bytes: &[u8], chunk: usize, tally: &mut Tally) {
    let mut lines = Lines::default();
    let mut count = |line: Line<'_>| match line {
        Line::Whole(line) => {
            assert!(line.len() <= MAX_LINE_BYTES);
            tally.read(line);
        }
        Line::TooLong => tally.reject(Rejected::TooLong),
    };
    for chunk in bytes.chunks(chunk) {
        lines.push(chunk, &mut count);
    }
    lines.finish(&mut count);
}
