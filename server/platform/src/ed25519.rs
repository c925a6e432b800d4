//! Ed25519 keys and signatures (RFC 8032) of firms, in hexadecimal digits.
//!
//! Invariants: only the holder of a private key can make a signature that is accepted for
//! its public key. For a public key of small order one signature fits every text, so such
//! keys are rejected.

use crate::error::{Error, Result};
use ed25519_dalek::{Signature, VerifyingKey};

/// Parses a public key of 64 hexadecimal digits.
///
/// # Errors
/// [`Error::Invalid`] if it is not a valid key.
pub fn key(public_key: &str) -> Result<VerifyingKey> {
    let bytes = from_hex(public_key).and_then(|bytes| bytes.try_into().ok());
    let bytes = bytes.ok_or_else(|| wrong("public_key", "is not 64 hexadecimal digits"))?;
    let key = VerifyingKey::from_bytes(&bytes)
        .map_err(|_| wrong("public_key", "is not an Ed25519 public key"))?;
    if key.is_weak() {
        return Err(wrong(
            "public_key",
            "is a key of small order: one of its signatures fits every text",
        ));
    }
    Ok(key)
}

/// Verifies the key's signature, 128 hexadecimal digits, over a text. `called` names the
/// text in the error.
///
/// # Errors
/// [`Error::Invalid`] with the field.
pub fn must_be_signed(
    key: &VerifyingKey,
    field: &'static str,
    signature: &str,
    text: &[u8],
    called: &str,
) -> Result<()> {
    let bytes = from_hex(signature).and_then(|bytes| bytes.try_into().ok());
    let bytes = bytes.ok_or_else(|| wrong(field, "is not 128 hexadecimal digits"))?;
    key.verify_strict(text, &Signature::from_bytes(&bytes))
        .map_err(|_| wrong(field, &format!("is not this key's signature over {called}")))
}

fn wrong(field: &'static str, detail: &str) -> Error {
    Error::Invalid {
        field,
        detail: detail.to_owned(),
    }
}

/// Encodes bytes as pairs of hexadecimal digits.
pub fn to_hex(bytes: &[u8]) -> String {
    let digits = bytes.iter().flat_map(|byte| [byte >> 4, byte & 15]);
    digits
        .filter_map(|digit| char::from_digit(u32::from(digit), 16))
        .collect()
}

/// Decodes pairs of hexadecimal digits into bytes.
pub fn from_hex(text: &str) -> Option<Vec<u8>> {
    let digits: Option<Vec<u32>> = text.chars().map(|c| c.to_digit(16)).collect();
    let digits = digits.filter(|digits| digits.len() % 2 == 0)?;
    Some(
        digits
            .chunks(2)
            .map(|pair| (16 * pair[0] + pair[1]) as u8)
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of order 1, 2, 4 and 8, and their other encodings.
    const SMALL: [&str; 8] = [
        "0100000000000000000000000000000000000000000000000000000000000000",
        "ecffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff7f",
        "0000000000000000000000000000000000000000000000000000000000000000",
        "0000000000000000000000000000000000000000000000000000000000000080",
        "26e8958fc2b227b045c3f489f2ef98f0d5dfac05d3c63339b13802886d53fc05",
        "c7176a703d4dd84fba3c0b760d10670f2a2053fa2c39ccc64ec7fd7792ac037a",
        "0100000000000000000000000000000000000000000000000000000000000080",
        "eeffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff7f",
    ];

    #[test]
    fn a_key_of_small_order_is_no_key() {
        for small in SMALL {
            let error = key(small).unwrap_err().to_string();
            assert!(error.contains("small order"), "{small}: {error}");
        }
    }

    /// RFC 8032, section 7.1, tests 2 and 3.
    #[test]
    fn a_signature_fits_its_key_and_its_text_only() {
        let one = key("3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c").unwrap();
        let other =
            key("fc51cd8e6218a1a38da47ed00230f0580816ed13ba3303ac5deb911548908025").unwrap();
        let signature = "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da\
                         085ac1e43e15996e458f3613d0f11d8c387b2eaeb4302aeeb00d291612bb0c00";
        let signed =
            |key: &VerifyingKey, text: &[u8]| must_be_signed(key, "proof", signature, text, "it");
        assert!(signed(&one, &[0x72]).is_ok());
        assert!(signed(&one, &[0x73]).is_err());
        assert!(signed(&other, &[0x72]).is_err());
        let short = must_be_signed(&one, "proof", "00", &[0x72], "it").unwrap_err();
        assert!(short.to_string().contains("128"), "{short}");
    }
}
