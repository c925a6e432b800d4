//! An adaptive binary range coder (Martin 1979): each bit costs as much as it
//! was unlikely.
//!
//! The bytes are the digits of a number from 0 up to 1. Each bit narrows the
//! range, and the number lies in the part that remains. Integers only: every
//! decoder in every language gets the same bits.

use super::error::DecodeError;

/// The range is widened by a byte when it is narrower than this.
const NARROW: u64 = 1 << 24;
const WHOLE: u64 = 1 << 32;
/// Bytes of the number that a decoder holds.
const NUMBER_BYTES: usize = 4;

/// An adaptive bit model: counts of 0 and 1 so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct BitModel([u32; 2]);

impl BitModel {
    /// The model before the first bit.
    pub(super) const INITIAL: BitModel = BitModel([2, 2]);
    /// Added to the count of each bit seen.
    const STEP: u32 = 5;
    /// Counts are halved when their sum exceeds this, so that the model adapts.
    const MAX_TOTAL: u32 = 320;

    /// The part of a range that belongs to 0.
    fn zero_share(self, range: u64) -> u64 {
        let [zeros, ones] = self.0.map(u64::from);
        range / (zeros + ones) * zeros
    }

    fn update(&mut self, bit: bool) {
        self.0[usize::from(bit)] += BitModel::STEP;
        if self.0.iter().sum::<u32>() > BitModel::MAX_TOTAL {
            self.0 = self.0.map(|count| count.div_ceil(2));
        }
    }
}

/// Writes bits.
#[derive(Clone, Debug)]
pub(super) struct RangeWriter {
    bytes: Vec<u8>,
    low: u64,
    range: u64,
}

impl RangeWriter {
    pub(super) fn new() -> RangeWriter {
        RangeWriter {
            bytes: Vec::new(),
            low: 0,
            range: WHOLE,
        }
    }

    /// Writes a modelled bit.
    pub(super) fn modelled_bit(&mut self, model: &mut BitModel, bit: bool) {
        self.narrow(model.zero_share(self.range), bit);
        model.update(bit);
    }

    /// Writes the lowest `count` bits of `value`, unmodelled.
    pub(super) fn bits(&mut self, value: u64, count: u32) {
        for shift in (0..count).rev() {
            self.narrow(self.range / 2, value >> shift & 1 == 1);
        }
    }

    /// The size in bits if the stream ended here, rounded up.
    pub(super) fn bits_written(&self) -> u64 {
        8 * self.bytes.len() as u64 + u64::from((WHOLE / self.range).ilog2())
    }

    /// Returns the fewest bytes that decode to these bits.
    pub(super) fn into_bytes(mut self) -> Vec<u8> {
        // A multiple of NARROW lies in a range that is not narrow. No byte is
        // needed where 0 or 1 lies in it.
        let end = self.low + self.range;
        if self.low > 0 && end <= WHOLE {
            self.low = self.low.next_multiple_of(NARROW);
            self.carry();
            self.bytes.push((self.low >> 24) as u8);
        } else if self.low > 0 {
            self.low = WHOLE;
            self.carry();
        }
        self.bytes
    }

    fn narrow(&mut self, zero_share: u64, bit: bool) {
        if bit {
            self.low += zero_share;
            self.range -= zero_share;
        } else {
            self.range = zero_share;
        }
        self.carry();
        while self.range < NARROW {
            self.bytes.push((self.low >> 24) as u8);
            self.low = self.low << 8 & (WHOLE - 1);
            self.range <<= 8;
        }
    }

    /// A sum that has reached 1 carries into the digits before.
    fn carry(&mut self) {
        if self.low < WHOLE {
            return;
        }
        self.low -= WHOLE;
        for byte in self.bytes.iter_mut().rev() {
            *byte = byte.wrapping_add(1);
            if *byte != 0 {
                return;
            }
        }
    }
}

/// Reads the bits of a [`RangeWriter`].
#[derive(Debug)]
pub(super) struct RangeReader<'a> {
    bytes: &'a [u8],
    /// Bytes read, including the zeros after the end.
    taken: usize,
    /// The number's offset in the range.
    number: u64,
    range: u64,
}

impl<'a> RangeReader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Result<RangeReader<'a>, DecodeError> {
        let mut reader = RangeReader {
            bytes,
            taken: 0,
            number: 0,
            range: WHOLE,
        };
        for _ in 0..NUMBER_BYTES {
            reader.take()?;
        }
        Ok(reader)
    }

    /// Reads a modelled bit.
    pub(super) fn modelled_bit(&mut self, model: &mut BitModel) -> Result<bool, DecodeError> {
        let bit = self.narrow(model.zero_share(self.range))?;
        model.update(bit);
        Ok(bit)
    }

    /// Reads an unmodelled, unsigned number of `count` bits, at most 64.
    pub(super) fn bits(&mut self, count: u32) -> Result<u64, DecodeError> {
        let mut value = 0;
        for _ in 0..count {
            value = value << 1 | u64::from(self.narrow(self.range / 2)?);
        }
        Ok(value)
    }

    /// Refuses bytes that no bit was read from.
    pub(super) fn finish(self) -> Result<(), DecodeError> {
        // The writer's last byte may not have been needed so far.
        if self.taken + 1 < self.bytes.len() + NUMBER_BYTES {
            return Err(DecodeError::TrailingBits);
        }
        Ok(())
    }

    fn narrow(&mut self, zero_share: u64) -> Result<bool, DecodeError> {
        let bit = self.number >= zero_share;
        if bit {
            self.number -= zero_share;
            self.range -= zero_share;
        } else {
            self.range = zero_share;
        }
        while self.range < NARROW {
            self.take()?;
            self.range <<= 8;
        }
        Ok(bit)
    }

    fn take(&mut self) -> Result<(), DecodeError> {
        if self.taken >= self.bytes.len() + NUMBER_BYTES {
            return Err(DecodeError::Truncated);
        }
        let byte = self.bytes.get(self.taken).copied().unwrap_or(0);
        self.taken += 1;
        self.number = self.number << 8 | u64::from(byte);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random bits, true once in `rare`, by a linear congruential generator.
    fn random_bits(seed: u64, count: usize, rare: u64) -> Vec<bool> {
        let mut state = seed;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            state >> 33
        };
        (0..count).map(|_| next() % rare == 0).collect()
    }

    fn written(bits: &[bool]) -> Vec<u8> {
        let (mut writer, mut model) = (RangeWriter::new(), BitModel::INITIAL);
        for bit in bits {
            writer.modelled_bit(&mut model, *bit);
            writer.bits(u64::from(*bit), 1);
        }
        writer.into_bytes()
    }

    fn read(bytes: &[u8], count: usize) -> Result<Vec<bool>, DecodeError> {
        let (mut reader, mut model) = (RangeReader::new(bytes)?, BitModel::INITIAL);
        let mut bits = Vec::new();
        for _ in 0..count {
            bits.push(reader.modelled_bit(&mut model)?);
            assert_eq!(reader.bits(1)?, u64::from(bits[bits.len() - 1]));
        }
        reader.finish()?;
        Ok(bits)
    }

    #[test]
    fn any_bits_come_back() {
        for seed in 0..300 {
            for rare in [1, 2, 3, 50, 5_000] {
                let sent = random_bits(seed, seed as usize, rare);
                let bytes = written(&sent);
                assert_eq!(read(&bytes, sent.len()).unwrap(), sent, "{seed} {rare}");
            }
        }
    }

    #[test]
    fn likely_bits_cost_little_and_unmodelled_bits_one_each() {
        let (mut writer, mut model) = (RangeWriter::new(), BitModel::INITIAL);
        for _ in 0..65_535 {
            writer.modelled_bit(&mut model, false);
        }
        assert!(writer.bits_written() < 700, "{}", writer.bits_written());
        let mut writer = RangeWriter::new();
        writer.bits(0x0123_4567_89ab_cdef, 64);
        assert_eq!(writer.bits_written(), 64);
        assert_eq!(writer.into_bytes(), 0x0123_4567_89ab_cdef_u64.to_be_bytes());
    }

    #[test]
    fn bytes_too_many_or_too_few_are_refused() {
        let sent = random_bits(1, 200, 3);
        let mut bytes = written(&sent);
        assert_eq!(
            read(&bytes[..bytes.len() - 6], 200),
            Err(DecodeError::Truncated)
        );
        bytes.extend([0, 0]);
        assert_eq!(read(&bytes, 200), Err(DecodeError::TrailingBits));
    }
}
