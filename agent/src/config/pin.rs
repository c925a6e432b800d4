//! The PIN of the page, hashed.

use argon2::Argon2;
use argon2::password_hash::phc::PasswordHash;
use argon2::password_hash::{PasswordHasher, PasswordVerifier};
use serde::Deserialize;
use std::fmt;
use std::ops::RangeInclusive;

/// Numbers of digits that a PIN may have. At one guess a minute, half of all PINs of six digits
/// take a year.
const DIGITS: RangeInclusive<usize> = 6..=12;

/// Hash of the PIN (Argon2id, RFC 9106) with its salt and parameters, as `page-pin` prints it.
#[derive(Clone, Deserialize)]
#[serde(try_from = "String")]
pub(crate) struct Pin(PasswordHash);

impl Pin {
    /// Hashes a PIN. Takes a tenth of a second, and 19 MiB of memory for that time.
    ///
    /// # Errors
    /// Fails for what is not 6 to 12 digits, and without a random source.
    pub(crate) fn hash(typed: &str) -> Result<Pin, String> {
        let is_pin = DIGITS.contains(&typed.len()) && typed.bytes().all(|b| b.is_ascii_digit());
        if !is_pin {
            let (least, most) = (DIGITS.start(), DIGITS.end());
            return Err(format!(
                "a PIN has {least} to {most} digits and nothing else"
            ));
        }
        let hash = Argon2::default().hash_password(typed.as_bytes());
        hash.map(Pin).map_err(|error| error.to_string())
    }

    /// Returns whether this is the PIN. Takes as long as [`Pin::hash`].
    pub(crate) fn matches(&self, typed: &str) -> bool {
        let verified = Argon2::default().verify_password(typed.as_bytes(), &self.0);
        verified.is_ok()
    }
}

impl TryFrom<String> for Pin {
    type Error = String;
    fn try_from(text: String) -> Result<Pin, String> {
        match PasswordHash::new(&text) {
            Ok(hash) if text.starts_with("$argon2id$") => Ok(Pin(hash)),
            _ => Err("it must be what `binnacle-agent page-pin` prints, not the PIN".to_owned()),
        }
    }
}

impl fmt::Display for Pin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Debug for Pin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Pin(…)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_pin_matches_its_hash_also_after_a_way_through_the_file() {
        let printed = Pin::hash("271828").unwrap().to_string();
        assert!(!printed.contains("271828"));
        let pin = Pin::try_from(printed).unwrap();
        assert!(pin.matches("271828"));
        for wrong in ["271829", "", " 271828"] {
            assert!(!pin.matches(wrong), "{wrong:?}");
        }
    }

    #[test]
    fn what_is_no_pin_and_what_is_no_hash_is_refused() {
        for typed in ["12345", "1234567890123", "12345a", ""] {
            assert!(Pin::hash(typed).is_err(), "{typed:?}");
        }
        let said = Pin::try_from("271828".to_owned()).unwrap_err();
        assert!(said.contains("page-pin"), "{said}");
    }
}
