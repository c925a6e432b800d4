//! Any bytes as a recording: nothing panics, the observations do not depend on how the file is cut
//! into chunks, and the time of its lines is known once any was.

#![no_main]

use binnacle_observation::recording::{Decoder, Plan, Recorded};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let whole = decode(bytes, bytes.len().max(1));
    assert_eq!(whole, decode(bytes, 7));
    let timed = whole.iter().skip_while(|recorded| recorded.at.is_none());
    assert!(timed.into_iter().all(|recorded| recorded.at.is_some()));
});

fn decode(bytes: &[u8], chunk: usize) -> Vec<Recorded> {
    let mut decoder = Decoder::new("fuzz".into(), Plan::default());
    for chunk in bytes.chunks(chunk) {
        decoder.chunk(chunk);
    }
    decoder.finish();
    decoder.take_recorded()
}
