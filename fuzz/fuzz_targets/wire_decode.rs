//! Any bytes, as they are and with the checksum made right: `decode` accepts or
//! refuses, and an accepted batch can be written again with the same meaning.

#![no_main]

use binnacle_wire::burst::{Joiner, read_ack};
use binnacle_wire::{EncodeError, decode, downlink, encode};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = decode(bytes);
    let _ = Joiner::default().push(bytes);
    let _ = read_ack(bytes);
    let _ = downlink::decode(bytes);
    let mut sealed = bytes.to_vec();
    sealed.extend(crc32fast::hash(bytes).to_le_bytes());
    let _ = downlink::decode(&sealed);
    let Ok(batch) = decode(&sealed) else { return };
    let again = match encode(&batch) {
        Ok(again) => again,
        // A smooth curve in finer steps than ours may take more room in ours.
        Err(EncodeError::TooLarge(_)) => return,
        Err(error) => panic!("what was decoded cannot be encoded: {error}"),
    };
    let batch = decode(&again).expect("what was encoded can be decoded");
    assert_eq!(encode(&batch).as_deref(), Ok(&again[..]));
});
