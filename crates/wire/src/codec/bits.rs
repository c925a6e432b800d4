//! Bit streams, the most significant bit first, and the three integer codes in
//! them.
//!
//! A reader never reads beyond its bytes; it returns
//! [`DecodeError::Truncated`].

use super::error::DecodeError;

/// Collects bits into bytes; the last byte is filled up with zeros.
#[derive(Debug, Default)]
pub(crate) struct BitWriter {
    bytes: Vec<u8>,
    /// Bits used in the last byte; 0 when it is full or there is none.
    used: u32,
}

impl BitWriter {
    /// Appends the lowest `count` bits of `value`; `count` is at most 64.
    pub(crate) fn bits(&mut self, value: u64, count: u32) {
        for shift in (0..count).rev() {
            let bit = (value >> shift & 1) as u8;
            if self.used == 0 {
                self.bytes.push(0);
            }
            if let Some(last) = self.bytes.last_mut() {
                *last |= bit << (7 - self.used);
            }
            self.used = (self.used + 1) % 8;
        }
    }

    /// Appends whole bytes.
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.bits(u64::from(*byte), 8);
        }
    }

    /// Appends Elias's gamma code of `value`, which is at least 1. Only frames
    /// of earlier agents use it.
    #[cfg(test)]
    pub(crate) fn gamma(&mut self, value: u64) {
        let below = value.ilog2();
        self.bits(0, below);
        self.bits(value, below + 1);
    }

    /// Appends seven bits at a time, the lowest first; the high bit of each
    /// byte says if more follow.
    pub(crate) fn varint(&mut self, mut value: u64) {
        while value > 0x7f {
            self.bits(value & 0x7f | 0x80, 8);
            value >>= 7;
        }
        self.bits(value, 8);
    }

    /// Returns the bytes written.
    pub(crate) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// Reads the bits of a [`BitWriter`].
#[derive(Debug)]
pub(crate) struct BitReader<'a> {
    bytes: &'a [u8],
    /// Bits already read.
    at: usize,
}

impl<'a> BitReader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> BitReader<'a> {
        BitReader { bytes, at: 0 }
    }

    /// Number of bits left.
    pub(crate) fn left(&self) -> usize {
        self.bytes.len() * 8 - self.at
    }

    /// Reads one bit.
    pub(crate) fn bit(&mut self) -> Result<bool, DecodeError> {
        let byte = self.bytes.get(self.at / 8).ok_or(DecodeError::Truncated)?;
        let bit = byte >> (7 - self.at % 8) & 1;
        self.at += 1;
        Ok(bit == 1)
    }

    /// Reads an unsigned number of `count` bits, at most 64.
    pub(crate) fn bits(&mut self, count: u32) -> Result<u64, DecodeError> {
        let mut value = 0;
        for _ in 0..count {
            value = value << 1 | u64::from(self.bit()?);
        }
        Ok(value)
    }

    /// Reads Elias's gamma code.
    pub(crate) fn gamma(&mut self) -> Result<u64, DecodeError> {
        let mut below = 0;
        while !self.bit()? {
            below += 1;
            if below > 63 {
                return Err(DecodeError::NumberTooLong);
            }
        }
        Ok(1 << below | self.bits(below)?)
    }

    /// Reads seven bits at a time, the lowest first.
    pub(crate) fn varint(&mut self) -> Result<u64, DecodeError> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let group = self.bits(8)?;
            let seven = group & 0x7f;
            // The tenth group has space for one bit only.
            if shift == 63 && seven > 1 {
                return Err(DecodeError::NumberTooLong);
            }
            value |= seven << shift;
            if group & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(DecodeError::NumberTooLong)
    }

    /// Reads whole bytes.
    pub(crate) fn bytes(&mut self, count: usize) -> Result<Vec<u8>, DecodeError> {
        if self.left() / 8 < count {
            return Err(DecodeError::Truncated);
        }
        (0..count).map(|_| Ok(self.bits(8)? as u8)).collect()
    }

    /// The remaining bytes, from the next byte boundary on.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at.div_ceil(8)..).unwrap_or_default()
    }

    /// Refuses anything but the zero bits that fill the last byte.
    pub(crate) fn finish(mut self) -> Result<(), DecodeError> {
        let left = self.left();
        if left > 7 || self.bits(left as u32)? != 0 {
            return Err(DecodeError::TrailingBits);
        }
        Ok(())
    }
}

/// Maps 0, −1, 1, −2 … to 0, 1, 2, 3 ….
pub(crate) fn zigzag(value: i64) -> u64 {
    (value << 1 ^ value >> 63).cast_unsigned()
}

/// Maps 0, 1, 2, 3 … to 0, −1, 1, −2 ….
pub(crate) fn unzigzag(code: u64) -> i64 {
    (code >> 1).cast_signed() ^ -(code & 1).cast_signed()
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGES: [u64; 7] = [1, 2, 127, 128, 1 << 32, u64::MAX - 1, u64::MAX];

    #[test]
    fn every_length_of_number_comes_back() {
        let mut writer = BitWriter::default();
        for value in EDGES {
            writer.gamma(value);
            writer.varint(value);
            writer.bits(value, 64);
        }
        writer.varint(0);
        let bytes = writer.into_bytes();
        let mut reader = BitReader::new(&bytes);
        for value in EDGES {
            assert_eq!(reader.gamma().unwrap(), value);
            assert_eq!(reader.varint().unwrap(), value);
            assert_eq!(reader.bits(64).unwrap(), value);
        }
        assert_eq!(reader.varint().unwrap(), 0);
        reader.finish().unwrap();
    }

    #[test]
    fn zigzag_is_its_own_way_back() {
        for value in [0, -1, 1, i64::MIN, i64::MAX] {
            assert_eq!(unzigzag(zigzag(value)), value);
        }
        assert_eq!([zigzag(0), zigzag(-1), zigzag(1)], [0, 1, 2]);
    }

    #[test]
    fn a_number_that_never_ends_is_refused() {
        let long = [0xff; 12];
        assert_eq!(
            BitReader::new(&long).varint(),
            Err(DecodeError::NumberTooLong)
        );
        let none = [0; 12];
        assert_eq!(
            BitReader::new(&none).gamma(),
            Err(DecodeError::NumberTooLong)
        );
        assert_eq!(
            BitReader::new(&none[..2]).gamma(),
            Err(DecodeError::Truncated)
        );
    }
}
