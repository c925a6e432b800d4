//! Any bytes, as they are and before a sentence: nothing panics, the parts lie
//! in the line in their order, and a time does not depend on the content.

#![no_main]

use binnacle_nmea::recording::{DateOrder, read_stamp, split};
use binnacle_nmea::{Tally, parse_tagged};
use libfuzzer_sys::fuzz_target;

const SENTENCE: &[u8] = b"$GPHDT,274.07,T*03";

fuzz_target!(|bytes: &[u8]| {
    for order in [DateOrder::MonthFirst, DateOrder::DayFirst] {
        parts(bytes, order);
        parts(&[bytes, SENTENCE].concat(), order);
        let _ = read_stamp(bytes, order);
    }
});

fn parts(line: &[u8], order: DateOrder) {
    let Some(recorded) = split(line, order) else { return };
    assert!(!recorded.content.is_empty());
    assert!(recorded.content.len() + recorded.rest.len() <= line.len());
    assert!(line.ends_with(recorded.rest));
    let whole = parse_tagged(recorded.content).is_ok();
    let read = Tally::default().read(recorded.content);
    assert!(!whole || read.is_some());
    // Each part is shorter than the line, so reading on comes to an end.
    if recorded.rest.len() < line.len() {
        parts(recorded.rest, order);
    }
}
