//! Passwords and tokens: creation, comparison and hashing. Only the hashes are stored.
//!
//! Invariants: a password is hashed by Argon2id with its own salt. A token has at least 128
//! random bits, so that a plain SHA-256 is enough.

use argon2::password_hash::phc::{Output, PasswordHash, Salt};
use argon2::{Algorithm, Argon2, Block, Params, Version};
use rand::{RngExt, rng};
use sha2::{Digest, Sha256};
use uuid::Uuid;

/// Returns the SHA-256 of a token, a code or a key, as it is stored.
pub fn hash(secret: &str) -> Vec<u8> {
    Sha256::digest(secret.as_bytes()).to_vec()
}

/// Returns `N` random bytes.
pub fn random<const N: usize>() -> [u8; N] {
    rng().random()
}

/// Creates a token of 256 random bits.
pub fn new_token() -> String {
    base64url(&random::<32>())
}

/// Derives a token from a secret and a purpose. It does not reveal the secret.
pub fn derived(purpose: &str, secret: &str) -> String {
    base64url(&hash(&format!("{purpose} {secret}")))
}

/// Creates a token that contains its vessel: 128 bits of the vessel's id and 128 random ones.
/// It is short because it crosses the satellite link with every batch.
pub fn new_vessel_token(vessel: Uuid) -> String {
    let mut bytes = [0; 32];
    bytes[..16].copy_from_slice(vessel.as_bytes());
    bytes[16..].copy_from_slice(&rng().random::<[u8; 16]>());
    base64url(&bytes)
}

/// Checks whether a token has the form of one from [`new_vessel_token`] for the vessel.
pub fn is_vessel_token(token: &str, vessel: Uuid) -> bool {
    from_base64url(token).is_some_and(|bytes| bytes.len() == 32)
        && vessel_of_token(token) == Some(vessel)
}

/// Returns the vessel in a token, whether or not the token is valid.
pub fn vessel_of_token(token: &str) -> Option<Uuid> {
    let bytes = from_base64url(token)?;
    Some(Uuid::from_bytes(bytes.get(..16)?.try_into().ok()?))
}

/// Creates a one-time code for people to read out: 80 random bits in Crockford's base 32, which
/// lacks I, L, O and U.
pub fn new_code() -> String {
    const LETTERS: &[u8; 32] = b"0123456789ABCDEFGHJKMNPQRSTVWXYZ";
    let letters: String = rng()
        .random::<[u8; 16]>()
        .iter()
        .map(|byte| char::from(LETTERS[usize::from(byte % 32)]))
        .collect();
    format!(
        "{}-{}-{}-{}",
        &letters[..4],
        &letters[4..8],
        &letters[8..12],
        &letters[12..]
    )
}

/// Normalises a typed code: case, spaces and hyphens do not matter.
pub fn normal_code(typed: &str) -> String {
    typed
        .chars()
        .filter(char::is_ascii_alphanumeric)
        .map(|letter| letter.to_ascii_uppercase())
        .collect()
}

/// Creates a password for people to copy: 96 random bits.
pub fn new_password() -> String {
    base64url(&rng().random::<[u8; 12]>())
}

/// Memory in which passwords are hashed, one after the other.
#[derive(Debug, Default)]
pub struct HashMemory(Vec<Block>);

/// Hashes a password; takes tens of milliseconds, so not for an async thread.
///
/// # Errors
/// Fails when the password is longer than Argon2 allows.
pub fn hash_password(password: &str, memory: &mut HashMemory) -> anyhow::Result<String> {
    let (algorithm, version, params) = Default::default();
    let salt = Salt::new(&random::<{ Salt::RECOMMENDED_LENGTH }>())?;
    let argon2 = Argon2::new(algorithm, version, params);
    let hash = derive(&argon2, password, &salt, Params::DEFAULT_OUTPUT_LEN, memory)?;
    let hashed = PasswordHash {
        algorithm: algorithm.ident(),
        version: Some(version.into()),
        params: argon2.params().try_into()?,
        salt: Some(salt),
        hash: Some(hash),
    };
    Ok(hashed.to_string())
}

/// Checks a password against a stored hash. Takes as long without a hash, so that the timing
/// does not reveal which e-mail addresses exist.
pub fn password_matches(password: &str, stored: Option<&str>, memory: &mut HashMemory) -> bool {
    // A user with an open invitation has no hash either.
    let Some(stored) = stored.filter(|stored| !stored.is_empty()) else {
        let _ = hash_password(password, memory);
        return false;
    };
    is_hash_of(password, stored, memory).unwrap_or(false)
}

fn is_hash_of(password: &str, stored: &str, memory: &mut HashMemory) -> anyhow::Result<bool> {
    let stored = PasswordHash::new(stored)?;
    let (Some(salt), Some(hash)) = (stored.salt, stored.hash) else {
        return Ok(false);
    };
    let version = stored.version.map(Version::try_from).transpose()?;
    let argon2 = Argon2::new(
        Algorithm::try_from(stored.algorithm.as_str())?,
        version.unwrap_or_default(),
        Params::try_from(&stored)?,
    );
    // The comparison takes the same time wherever they differ.
    Ok(derive(&argon2, password, &salt, hash.len(), memory)? == hash)
}

/// Returns Argon2's output of `length` bytes for a password and a salt.
fn derive(
    argon2: &Argon2<'_>,
    password: &str,
    salt: &Salt,
    length: usize,
    memory: &mut HashMemory,
) -> anyhow::Result<Output> {
    let blocks = argon2.params().block_count();
    memory.0.resize(blocks, Block::default());
    let mut output = vec![0; length];
    argon2.hash_password_into_with_memory(
        password.as_bytes(),
        salt,
        &mut output,
        memory.0.as_mut_slice(),
    )?;
    Ok(Output::new(&output)?)
}

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

/// Encodes bytes in base64url (RFC 4648, section 5) without padding.
pub(crate) fn base64url(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len() * 4 / 3 + 2);
    for chunk in bytes.chunks(3) {
        let word = chunk
            .iter()
            .chain([0, 0].iter())
            .take(3)
            .fold(0_u32, |word, byte| word << 8 | u32::from(*byte));
        for digit in 0..=chunk.len() {
            text.push(char::from(DIGITS[(word >> (18 - 6 * digit)) as usize & 63]));
        }
    }
    text
}

/// Decodes base64url without padding.
pub(crate) fn from_base64url(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() * 3 / 4);
    let (mut word, mut bits) = (0_u32, 0_u32);
    for letter in text.bytes() {
        let digit = DIGITS.iter().position(|known| *known == letter)?;
        word = word << 6 | u32::try_from(digit).ok()?;
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.push((word >> bits) as u8);
            word &= (1 << bits) - 1;
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use argon2::{PasswordHasher, PasswordVerifier};

    #[test]
    fn hashes_are_those_of_the_library_in_memory_that_was_used() {
        let mut memory = HashMemory::default();
        let (right, wrong) = ("nine bells at noon", "eight bells at noon");
        let ours = hash_password(right, &mut memory).unwrap();
        assert!(
            ours.starts_with("$argon2id$v=19$m=19456,t=2,p=1$"),
            "{ours}"
        );
        assert!(
            Argon2::default()
                .verify_password(right.as_bytes(), ours.as_str())
                .is_ok()
        );
        let theirs = Argon2::default().hash_password(right.as_bytes()).unwrap();
        for stored in [ours, theirs.to_string()] {
            assert!(password_matches(right, Some(&stored), &mut memory));
            assert!(!password_matches(wrong, Some(&stored), &mut memory));
        }
        for stored in [
            None,
            Some(""),
            Some("$argon2id$v=19$m=19456,t=2,p=1$c2FsdHNhbHQ"),
        ] {
            assert!(!password_matches(right, stored, &mut memory));
        }
    }

    #[test]
    fn a_vessel_token_names_its_vessel() {
        let vessel = Uuid::now_v7();
        let token = new_vessel_token(vessel);
        assert_eq!(token.len(), 43);
        assert_eq!(vessel_of_token(&token), Some(vessel));
        assert_ne!(token, new_vessel_token(vessel));
        assert!(is_vessel_token(&token, vessel));
        assert!(!is_vessel_token(&token, Uuid::now_v7()));
        assert!(!is_vessel_token(&token[..40], vessel));
        assert_eq!(vessel_of_token("short"), None);
        assert_eq!(vessel_of_token(&"é".repeat(43)), None);
    }

    #[test]
    fn base64url_gives_the_examples_of_rfc_4648() {
        for (plain, coded) in [("", ""), ("f", "Zg"), ("fo", "Zm8"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64url(plain.as_bytes()), coded);
            assert_eq!(from_base64url(coded).unwrap(), plain.as_bytes());
        }
    }

    #[test]
    fn a_code_may_be_typed_in_lower_case_without_hyphens() {
        let code = new_code();
        assert_eq!(code.len(), 19);
        assert_eq!(
            normal_code(&code.to_lowercase().replace('-', " ")),
            normal_code(&code)
        );
    }
}
