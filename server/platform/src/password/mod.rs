//! Password rules, after NIST SP 800-63B, section 3.1.1.2: passwords are long and use any
//! characters. They are neither common nor easily guessed for this person. No mix of
//! character classes is required, and no password expires.

mod hashing;

pub use hashing::{Hashing, Permit};

use crate::error::{Error, Result};
use zxcvbn::{Score, zxcvbn};

/// Minimum length, characters.
pub const MIN_LENGTH: usize = 12;
/// Maximum length, bytes: Argon2 accepts any length, but nobody types more.
pub const MAX_BYTES: usize = 1024;
/// Lowest accepted strength: more than 10⁸ guesses. Wheeler, "zxcvbn: Low-Budget Password Strength
/// Estimation", USENIX Security 2016.
const LEAST_SCORE: Score = Score::Three;
/// Number of characters that are judged. The time for it grows with the square of the length, and a
/// password that is strong so far is not weaker for what follows.
const JUDGED: usize = 40;
/// Words of the trade and of this product, which are tried first here.
const OWN_WORDS: &[&str] = &[
    "binnacle",
    "compass",
    "deviation",
    "captain",
    "vessel",
    "fleet",
    "maritime",
    "shipping",
];

/// Refuses a password that is short or easily guessed. `about` is known of the user: e-mail,
/// name, company.
///
/// # Errors
/// [`Error::Invalid`] with `field`.
pub fn check(field: &'static str, password: &str, about: &[&str]) -> Result<()> {
    let wrong = |detail: String| Err(Error::Invalid { field, detail });
    if password.chars().count() < MIN_LENGTH {
        return wrong(format!("has fewer than {MIN_LENGTH} characters"));
    }
    if password.len() > MAX_BYTES {
        return wrong(format!("is longer than {MAX_BYTES} bytes"));
    }
    if is_guessable(password, about) {
        return wrong(
            "is easily guessed: use several words that do not belong together".to_owned(),
        );
    }
    Ok(())
}

/// Checks whether someone who knows common passwords, words, rows of keys and the user would need
/// few guesses.
fn is_guessable(password: &str, about: &[&str]) -> bool {
    let squeezed = about.iter().map(|text| text.replace(' ', ""));
    let parts = about
        .iter()
        .flat_map(|text| text.split(|letter: char| !letter.is_alphanumeric()))
        .map(str::to_owned);
    let whole = about.iter().map(|text| (*text).to_owned());
    let own = OWN_WORDS.iter().map(|word| (*word).to_owned());
    let known: Vec<String> = whole.chain(squeezed).chain(parts).chain(own).collect();
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    let end = password.char_indices().nth(JUDGED);
    let judged = end.map_or(password, |(end, _)| &password[..end]);
    zxcvbn(judged, &known).score() < LEAST_SCORE
}

#[cfg(test)]
mod tests {
    use super::*;

    const ABOUT: [&str; 3] = [
        "ada.l@northern.example",
        "Ada Lovelace",
        "Northern Star Lines",
    ];

    #[test]
    fn a_short_common_or_personal_password_is_refused() {
        for weak in [
            "x7!kQ2#vB9z",
            "password1234",
            "Passw0rd2026",
            "123456789012",
            "aaaaaaaaaaaa",
            "abcdefghijkl",
            "qwertyuiop12",
            "1q2w3e4r5t6z",
            "ada.l@northern.example",
            "adalovelace1815",
            "northernstarlines",
            "Binnacle-2026",
            "welcomewelcome!",
            "iloveyou1234",
            "Password123!",
            "qwerty123456",
            "1234567890ab",
            "letmein12345",
            "administrator",
            "P@ssw0rd1234",
            "trustno1trustno1",
            "zxcvbnm,./123",
        ] {
            let refused = check("password", weak, &ABOUT);
            assert!(
                matches!(
                    refused,
                    Err(Error::Invalid {
                        field: "password",
                        ..
                    })
                ),
                "{weak}"
            );
        }
        assert!(check("password", &"xk".repeat(600), &ABOUT).is_err());
    }

    #[test]
    fn any_characters_are_accepted_if_there_are_enough() {
        for good in [
            "correct horse battery",
            "vk9rw2hqx7mt",
            "наш якорь поднят",
            "Lovelace wrote the first one",
            "七つの海を渡る羅針盤の物語",
        ] {
            assert!(check("password", good, &ABOUT).is_ok(), "{good}");
        }
    }
}
