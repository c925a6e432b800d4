//! Time-based codes (RFC 6238 with RFC 4226): SHA-1, six digits, thirty seconds, which every
//! authenticator app supports.
//!
//! Invariants: a code belongs to one time step. The caller names the last used step, and only
//! later steps are accepted, so a code that was seen once is worthless.

use binnacle_compass::time::Timestamp;
use ring::hmac;

/// Length of a secret in bytes, equal to the hash's (RFC 4226, section 4, requirement 6).
pub(crate) const SECRET_BYTES: usize = 20;
const STEP_S: i64 = 30;
const CODES: u32 = 1_000_000;
/// Steps that a phone's clock may be off (RFC 6238, section 5.2).
const OFF_BY: i64 = 1;

/// Returns the time step of an instant (RFC 6238, section 4.2).
pub(super) fn step_at(now: Timestamp) -> i64 {
    now.micros().div_euclid(1_000_000 * STEP_S)
}

/// Returns the step of a code, if it is a current one later than `after`.
pub(super) fn step_of(secret: &[u8], code: &str, after: i64, now: Timestamp) -> Option<i64> {
    let typed: String = code.chars().filter(|letter| *letter != ' ').collect();
    let now = step_at(now);
    (now - OFF_BY..=now + OFF_BY)
        .filter(|step| *step > after)
        .find(|step| same(&code_at(secret, *step), &typed))
}

/// Returns the code of a step (RFC 4226, section 5.3).
pub(super) fn code_at(secret: &[u8], step: i64) -> String {
    let key = hmac::Key::new(hmac::HMAC_SHA1_FOR_LEGACY_USE_ONLY, secret);
    let hash = hmac::sign(&key, &step.to_be_bytes());
    let hash = hash.as_ref();
    let offset = usize::from(hash[hash.len() - 1] & 0xf);
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| u32::from(hash[offset + i]));
    let number = (a & 0x7f) << 24 | b << 16 | c << 8 | d;
    format!("{:06}", number % CODES)
}

/// Compares two texts in constant time.
fn same(one: &str, other: &str) -> bool {
    one.len() == other.len()
        && one
            .bytes()
            .zip(other.bytes())
            .fold(0, |all, (a, b)| all | (a ^ b))
            == 0
}

/// Encodes bytes in base 32 (RFC 4648, section 6) without padding, as people type secrets.
pub(crate) fn base32(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 32] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZ234567";
    let mut text = String::with_capacity(bytes.len() * 8 / 5 + 1);
    for chunk in bytes.chunks(5) {
        let word = chunk
            .iter()
            .chain([0; 5].iter())
            .take(5)
            .fold(0_u64, |word, byte| word << 8 | u64::from(*byte));
        for digit in 0..(chunk.len() * 8).div_ceil(5) {
            text.push(char::from(DIGITS[(word >> (35 - 5 * digit)) as usize & 31]));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const RFC: &[u8] = b"12345678901234567890";

    fn at(second: i64) -> Timestamp {
        Timestamp::from_micros(second * 1_000_000).unwrap()
    }

    #[test]
    fn rfc_4226_appendix_d_gives_these_codes() {
        let codes: Vec<String> = (0..10).map(|step| code_at(RFC, step)).collect();
        let given = [
            "755224", "287082", "359152", "969429", "338314", "254676", "287922", "162583",
            "399871", "520489",
        ];
        assert_eq!(codes, given);
    }

    #[test]
    fn rfc_6238_appendix_b_gives_these_codes() {
        // Its eight digits for SHA-1; the last six are the code of six digits.
        for (second, code) in [
            (59, "94287082"),
            (1_111_111_109, "07081804"),
            (1_111_111_111, "14050471"),
            (1_234_567_890, "89005924"),
            (2_000_000_000, "69279037"),
        ] {
            assert_eq!(code_at(RFC, step_at(at(second))), code[2..]);
        }
    }

    #[test]
    fn a_code_is_good_for_one_step_more_on_either_side_and_once() {
        let now = at(1_111_111_111);
        let step = step_at(now);
        for off in [-1, 0, 1] {
            let code = code_at(RFC, step + off);
            assert_eq!(step_of(RFC, &code, 0, now), Some(step + off));
            assert_eq!(step_of(RFC, &code, step + off, now), None);
        }
        for off in [-2, 2] {
            assert_eq!(step_of(RFC, &code_at(RFC, step + off), 0, now), None);
        }
        assert_eq!(step_of(RFC, "050 471", 0, now), Some(step));
        for odd in ["", "050", "0504710", "９５０４７１"] {
            assert_eq!(step_of(RFC, odd, 0, now), None);
        }
    }

    #[test]
    fn base32_gives_the_examples_of_rfc_4648() {
        for (plain, coded) in [
            ("", ""),
            ("f", "MY"),
            ("fo", "MZXQ"),
            ("foo", "MZXW6"),
            ("foob", "MZXW6YQ"),
            ("fooba", "MZXW6YTB"),
            ("foobar", "MZXW6YTBOI"),
        ] {
            assert_eq!(base32(plain.as_bytes()), coded);
        }
    }
}
