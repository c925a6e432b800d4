//! Residuals in blocks of up to 128, each block with the code that suits it
//! best.
//!
//! A block begins with four bits: 0 to 13 is the parameter of a Rice code with
//! an escape for outliers, 14 codes runs of zeros, 15 means that all are zero.

use super::bits::{BitReader, unzigzag};
use super::error::DecodeError;

/// Residuals per block.
const BLOCK: usize = 128;

const ZERO_RUNS: u32 = 14;
const ALL_ZERO: u32 = 15;
/// Quotient, in ones, that stands for an escape.
const ESCAPE: u64 = 24;

/// The least number of bits of `count` residuals: the blocks' code numbers.
pub(super) fn min_bits(count: usize) -> usize {
    count.div_ceil(BLOCK) * 4
}

/// Reads `count` residuals and passes each to `take`.
pub(super) fn read(
    reader: &mut BitReader<'_>,
    count: usize,
    column: u64,
    mut take: impl FnMut(i64) -> Result<(), DecodeError>,
) -> Result<(), DecodeError> {
    let mut left = count;
    while left > 0 {
        let block = left.min(BLOCK);
        match reader.bits(4)? as u32 {
            ALL_ZERO => (0..block).try_for_each(|_| take(0))?,
            ZERO_RUNS => read_runs(reader, block, column, &mut take)?,
            k => {
                for _ in 0..block {
                    take(unzigzag(read_rice(reader, k)?))?;
                }
            }
        }
        left -= block;
    }
    Ok(())
}

fn read_rice(reader: &mut BitReader<'_>, k: u32) -> Result<u64, DecodeError> {
    let mut quotient = 0;
    while quotient < ESCAPE && reader.bit()? {
        quotient += 1;
    }
    if quotient < ESCAPE {
        return Ok(quotient << k | reader.bits(k)?);
    }
    let length = reader.bits(6)? as u32 + 1;
    reader.bits(length)
}

fn read_runs(
    reader: &mut BitReader<'_>,
    block: usize,
    column: u64,
    take: &mut impl FnMut(i64) -> Result<(), DecodeError>,
) -> Result<(), DecodeError> {
    let mut left = block as u64;
    while left > 0 {
        let zeros = reader.gamma()? - 1;
        if zeros > left {
            return Err(DecodeError::BadRun(column));
        }
        (0..zeros).try_for_each(|_| take(0))?;
        left -= zeros;
        if left > 0 {
            take(unzigzag(reader.gamma()?))?;
            left -= 1;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::bits::BitWriter;

    fn block(count: usize, write: impl Fn(&mut BitWriter)) -> Result<Vec<i64>, DecodeError> {
        let mut writer = BitWriter::default();
        write(&mut writer);
        let bytes = writer.into_bytes();
        let (mut reader, mut found) = (BitReader::new(&bytes), Vec::new());
        read(&mut reader, count, 9, |residual| {
            found.push(residual);
            Ok(())
        })?;
        reader.finish()?;
        Ok(found)
    }

    #[test]
    fn every_kind_of_block_is_read() {
        let zeros = block(130, |w| w.bits(0xff, 8));
        assert_eq!(zeros.unwrap(), [0; 130]);
        // k is 1: a quotient in ones and a zero, then one bit.
        let rice = block(3, |w| {
            w.bits(1, 4);
            w.bits(0b1101, 4);
            w.bits(0b00, 2);
            w.bits(0b01, 2);
        });
        assert_eq!(rice.unwrap(), [-3, 0, -1]);
        // Two zeros, 2; one zero, and the block is full.
        let runs = block(4, |w| {
            w.bits(14, 4);
            w.gamma(3);
            w.gamma(4);
            w.gamma(2);
        });
        assert_eq!(runs.unwrap(), [0, 0, 2, 0]);
    }

    #[test]
    fn an_outlier_escapes_at_its_full_length() {
        for code in [1 << 30, u64::MAX - 1, u64::MAX] {
            let read = block(1, |w| {
                w.bits(0, 4);
                w.bits(u64::MAX, 24);
                w.bits(u64::from(code.ilog2()), 6);
                w.bits(code, code.ilog2() + 1);
            });
            assert_eq!(read.unwrap(), [unzigzag(code)]);
        }
    }

    #[test]
    fn a_run_beyond_the_block_is_refused() {
        let read = block(4, |w| {
            w.bits(14, 4);
            w.gamma(6);
        });
        assert_eq!(read, Err(DecodeError::BadRun(9)));
    }
}
