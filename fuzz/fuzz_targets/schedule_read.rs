//! Any bytes as a schedule's input: nothing panics, and what is read is read the same when it is
//! written again.

#![no_main]

use binnacle_schedule::input::read;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let Ok(input) = read(text) else { return };
    let written = serde_json::to_string(input.get()).expect("an input has a JSON form");
    let again = read(&written).expect("what was read is consistent");
    assert_eq!(again, input);
});
