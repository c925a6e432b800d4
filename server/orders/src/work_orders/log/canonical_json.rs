//! Canonical JSON of log entries and records, and its SHA-256.

use binnacle_platform::error::Result;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// Writes a value as canonical JSON: keys in order, no blanks.
///
/// # Errors
/// Fails when it cannot be written as JSON.
pub(crate) fn canonical(value: &impl Serialize) -> Result<String> {
    // serde_json's map is sorted; a test below holds it to that.
    Ok(serde_json::to_string(&serde_json::to_value(value)?)?)
}

/// Returns the SHA-256 as hexadecimal.
pub fn sha256_hex(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(64);
    for byte in Sha256::digest(bytes) {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn canonical_json_has_its_keys_in_order() {
        let value = json!({ "b": 1, "a": { "d": [1.5], "c": null } });
        assert_eq!(
            canonical(&value).unwrap(),
            r#"{"a":{"c":null,"d":[1.5]},"b":1}"#
        );
    }

    #[test]
    fn a_hash_is_that_of_the_standard() {
        // FIPS 180-4, example B.1.
        assert_eq!(
            sha256_hex(b"abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }
}
