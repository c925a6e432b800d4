//! Bytes of the cache: compressed, behind the hash by which damage is noticed.

use anyhow::{Context, ensure};
use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use sha2::{Digest, Sha256};
use std::io::{Read, Write};

const HASH_BYTES: usize = 32;
/// Most bytes that are inflated: a hundred times a usual state.
const MOST_BYTES: u64 = 512 << 20;

/// Compresses bytes and seals them.
///
/// # Errors
/// Fails when the memory does not suffice.
pub(super) fn seal(bytes: &[u8]) -> anyhow::Result<Vec<u8>> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes)?;
    let packed = encoder.finish()?;
    let mut sealed = Sha256::digest(&packed).to_vec();
    sealed.extend(packed);
    Ok(sealed)
}

/// Returns the bytes that were sealed.
///
/// # Errors
/// Fails when they are damaged.
pub(super) fn unseal(sealed: &[u8]) -> anyhow::Result<Vec<u8>> {
    let (hash, packed) = sealed
        .split_at_checked(HASH_BYTES)
        .context("sealed bytes are too short")?;
    ensure!(
        Sha256::digest(packed).as_slice() == hash,
        "sealed bytes do not agree with their hash"
    );
    let mut bytes = Vec::new();
    DeflateDecoder::new(packed)
        .take(MOST_BYTES)
        .read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_flipped_bit_is_noticed() {
        let sealed = seal(b"state of an analysis, state of an analysis").unwrap();
        assert_eq!(
            unseal(&sealed).unwrap(),
            b"state of an analysis, state of an analysis"
        );
        for place in 0..sealed.len() {
            for bit in 0..8 {
                let mut damaged = sealed.clone();
                damaged[place] ^= 1 << bit;
                assert!(unseal(&damaged).is_err());
            }
            assert!(unseal(&sealed[..place]).is_err());
        }
    }
}
