//! Password rules, after NIST SP 800-63B, section 3.1.1.2: passwords are long and use any
//! characters. They are neither common nor easily guessed for this person. No mix of
//! character classes is required, and no password expires.

mod common;
mod hashing;

pub use hashing::{Hashing, Permit};

use crate::error::{Error, Result};

/// Minimum length, characters.
pub const MIN_LENGTH: usize = 12;
/// Maximum length, bytes: Argon2 accepts any length, but nobody types more.
pub const MAX_BYTES: usize = 1024;
/// Minimum number of characters left after all easily guessed parts are removed.
const MIN_UNGUESSED: usize = 6;
/// Minimum length of a word that counts as easily guessed.
const MIN_WORD: usize = 4;

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
    if count_unguessed(password, about) < MIN_UNGUESSED {
        return wrong(
            "is easily guessed: it is little more than a common word, a row of keys, \
             or the e-mail, name or company"
                .to_owned(),
        );
    }
    Ok(())
}

/// Returns the number of characters that remain for an attacker who knows common words, rows of
/// letters and these names.
fn count_unguessed(password: &str, about: &[&str]) -> usize {
    let mut rest = password.to_lowercase();
    let about: Vec<String> = about.iter().map(|text| text.to_lowercase()).collect();
    let squeezed: Vec<String> = about.iter().map(|text| text.replace(' ', "")).collect();
    let whole = about.iter().chain(&squeezed).map(String::as_str);
    let parts = about
        .iter()
        .flat_map(|text| text.split(|letter: char| !letter.is_alphanumeric()));
    let mut words: Vec<&str> = whole
        .chain(parts)
        .chain(common::WORDS.iter().copied())
        .collect();
    words.retain(|word| word.chars().count() >= MIN_WORD);
    words.sort_by_key(|word| std::cmp::Reverse(word.len()));
    for word in words {
        rest = rest.replace(word, " ");
    }
    let letters: Vec<char> = rest
        .chars()
        .filter(|letter| !letter.is_whitespace())
        .collect();
    let goes_on = |pair: &[char]| u32::from(pair[0]).abs_diff(u32::from(pair[1])) <= 1;
    let rows = letters.windows(2).filter(|pair| goes_on(pair)).count();
    letters.len() - rows
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
