//! Seals of the secrets that the database has to give back, which cannot be hashed: those of
//! authenticator apps and webhooks, and the server's signing keys.
//!
//! Invariants: a secret is sealed by AES-256-GCM (NIST SP 800-38D) with a key that is not in the
//! database, and is bound to its row: the seal of one row opens no other. The row names its key, so
//! that keys can be changed while the server runs. Without a key secrets are stored in plain.

use crate::secret;
use ring::aead::{AES_256_GCM, Aad, LessSafeKey, NONCE_LEN, Nonce, UnboundKey};
use std::fmt;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::sync::Arc;
use tracing::warn;

/// Length of a key, bytes.
const KEY_BYTES: usize = 32;

/// Keys by which secrets are sealed and opened. The first one seals.
#[derive(Clone, Default)]
pub struct Seals(Arc<[SealingKey]>);

struct SealingKey {
    id: String,
    key: LessSafeKey,
}

/// Secret as it is stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredSecret {
    /// Nonce, sealed secret and tag; or the secret in plain.
    pub bytes: Vec<u8>,
    /// Id of the key; none if the secret is in plain.
    pub sealed_by: Option<String>,
}

/// Failure to open a stored secret.
#[derive(Debug, thiserror::Error)]
pub enum SealError {
    /// None of the keys has this id.
    #[error(
        "a secret in the database is sealed by the key {0}, which is not among those of \
         BINNACLE_SECRETS_KEY or BINNACLE_SECRETS_KEY_FILE"
    )]
    UnknownKey(String),
    /// The stored bytes were altered, or belong to another row.
    #[error("the sealed secret of {0} is damaged")]
    Damaged(String),
}

impl From<SealError> for sqlx::Error {
    fn from(error: SealError) -> sqlx::Error {
        sqlx::Error::Decode(Box::new(error))
    }
}

impl fmt::Debug for Seals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ids: Vec<&str> = self.0.iter().map(|key| key.id.as_str()).collect();
        write!(f, "Seals({})", ids.join(", "))
    }
}

impl Seals {
    /// Parses keys of 64 hexadecimal digits, separated by commas or blanks.
    ///
    /// # Errors
    /// Says what is wrong with one of them, without its digits.
    pub fn parse(text: &str) -> Result<Seals, String> {
        let words = text.split(|c: char| c == ',' || c.is_whitespace());
        let words = words.filter(|word| !word.is_empty());
        let keys: Result<Vec<SealingKey>, String> = words.map(SealingKey::parse).collect();
        let keys = keys?;
        if keys.is_empty() {
            return Err("there is no key".to_owned());
        }
        Ok(Seals(keys.into()))
    }

    /// Reads keys from a file, the one that seals first. Warns if others than its owner may read it.
    ///
    /// # Errors
    /// Fails when the file cannot be read, or has something else in it.
    pub fn read(file: &Path) -> Result<Seals, String> {
        let text = std::fs::read_to_string(file)
            .map_err(|error| format!("cannot read {}: {error}", file.display()))?;
        let mode = std::fs::metadata(file).map_or(0, |file| file.permissions().mode());
        if mode & 0o077 != 0 {
            warn!(
                file = %file.display(),
                "other accounts may read the keys that seal secrets: chmod 600"
            );
        }
        Seals::parse(&text).map_err(|error| format!("{}: {error}", file.display()))
    }

    /// Returns the id of the key that seals; none if there is no key.
    pub fn current(&self) -> Option<&str> {
        self.0.first().map(|key| key.id.as_str())
    }

    /// Returns true if one of the keys has the id.
    pub fn has(&self, id: &str) -> bool {
        self.0.iter().any(|key| key.id == id)
    }

    /// Seals a secret for its row; without a key it stays in plain.
    #[allow(clippy::missing_panics_doc, reason = "it cannot: see the messages")]
    pub fn seal(&self, row: &str, plain: &[u8]) -> StoredSecret {
        let Some(key) = self.0.first() else {
            return StoredSecret {
                bytes: plain.to_vec(),
                sealed_by: None,
            };
        };
        let nonce = secret::random::<NONCE_LEN>();
        let mut sealed = plain.to_vec();
        key.key
            .seal_in_place_append_tag(
                Nonce::assume_unique_for_key(nonce),
                Aad::from(row.as_bytes()),
                &mut sealed,
            )
            .expect("a secret is far shorter than the limit of AES-GCM");
        StoredSecret {
            bytes: [nonce.as_slice(), &sealed].concat(),
            sealed_by: Some(key.id.clone()),
        }
    }

    /// Returns the secret of a row.
    ///
    /// # Errors
    /// Fails when the key is not known, or the stored bytes are not those that were sealed for
    /// this row.
    pub fn open(&self, row: &str, stored: &StoredSecret) -> Result<Vec<u8>, SealError> {
        let Some(id) = &stored.sealed_by else {
            return Ok(stored.bytes.clone());
        };
        let key = self.0.iter().find(|key| key.id == *id);
        let key = key.ok_or_else(|| SealError::UnknownKey(id.clone()))?;
        let damaged = || SealError::Damaged(row.to_owned());
        let (nonce, sealed) = stored
            .bytes
            .split_at_checked(NONCE_LEN)
            .ok_or_else(damaged)?;
        let nonce = Nonce::try_assume_unique_for_key(nonce).map_err(|_| damaged())?;
        let mut bytes = sealed.to_vec();
        let opened = key
            .key
            .open_in_place(nonce, Aad::from(row.as_bytes()), &mut bytes);
        Ok(opened.map_err(|_| damaged())?.to_vec())
    }
}

impl SealingKey {
    fn parse(digits: &str) -> Result<SealingKey, String> {
        let pairs = digits.as_bytes().chunks(2);
        let bytes: Option<Vec<u8>> = pairs
            .map(|pair| {
                let pair = std::str::from_utf8(pair).ok()?;
                let is_hex = pair.bytes().all(|digit| digit.is_ascii_hexdigit());
                is_hex.then(|| u8::from_str_radix(pair, 16).ok()).flatten()
            })
            .collect();
        let bytes = bytes.filter(|bytes| bytes.len() == KEY_BYTES && digits.len() == 64);
        let bytes =
            bytes.ok_or("a key has 64 hexadecimal digits, as `openssl rand -hex 32` gives")?;
        let key = UnboundKey::new(&AES_256_GCM, &bytes).map_err(|error| error.to_string())?;
        let id = secret::hash(&format!("id of the key {}", digits.to_lowercase()));
        Ok(SealingKey {
            id: secret::base64url(&id[..9]),
            key: LessSafeKey::new(key),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(letters: &str) -> Seals {
        let keys: Vec<String> = letters.chars().map(|c| c.to_string().repeat(64)).collect();
        Seals::parse(&keys.join(",\n")).unwrap()
    }

    #[test]
    fn a_secret_is_opened_by_its_key_for_its_row_alone() {
        let seals = keys("a");
        let stored = seals.seal("webhook 1", b"bns_secret");
        assert_eq!(stored.sealed_by.as_deref(), seals.current());
        assert!(!stored.bytes.windows(6).any(|part| part == b"secret"));
        assert_ne!(stored, seals.seal("webhook 1", b"bns_secret"));
        assert_eq!(seals.open("webhook 1", &stored).unwrap(), b"bns_secret");
        let other_row = seals.open("webhook 2", &stored);
        assert!(matches!(other_row, Err(SealError::Damaged(_))));
        for seals in [keys("b"), Seals::default()] {
            let refused = seals.open("webhook 1", &stored);
            assert!(matches!(refused, Err(SealError::UnknownKey(_))));
        }
        for at in 0..stored.bytes.len() {
            let mut altered = stored.clone();
            altered.bytes[at] ^= 1;
            assert!(seals.open("webhook 1", &altered).is_err(), "{at}");
            altered.bytes.truncate(at);
            assert!(seals.open("webhook 1", &altered).is_err(), "{at}");
        }
    }

    #[test]
    fn the_first_key_seals_and_all_open() {
        let stored = keys("a").seal("row", b"secret");
        let rotated = keys("ba");
        assert_eq!(rotated.open("row", &stored).unwrap(), b"secret");
        let again = rotated.seal("row", b"secret");
        assert_eq!(keys("b").open("row", &again).unwrap(), b"secret");
        let plain = Seals::default().seal("row", b"secret");
        assert_eq!(plain.sealed_by, None);
        assert_eq!(rotated.open("row", &plain).unwrap(), b"secret");
    }

    #[test]
    fn a_key_of_another_form_is_refused_without_its_digits() {
        let long = "a".repeat(66);
        for wrong in ["", " , ", "secret-key", &long[..62], &long, &"g".repeat(64)] {
            let refused = Seals::parse(wrong).unwrap_err();
            assert!(
                wrong.trim().len() < 4 || !refused.contains(wrong),
                "{refused}"
            );
        }
        let seals = keys("a");
        assert!(!format!("{seals:?}").contains("aaaa"), "{seals:?}");
        assert_eq!(
            Seals::parse(&"A".repeat(64)).unwrap().current(),
            seals.current()
        );
    }
}
