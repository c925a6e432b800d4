//! Residuals in blocks of up to 128, each with the code that suits it best.
//!
//! A block begins with four bits: 0 to 13 is the parameter of a Rice code with
//! an escape for outliers, 14 codes runs of zeros, 15 says that all are zero.

use super::bits::{BitReader, BitWriter, unzigzag, zigzag};
use super::error::DecodeError;

/// Residuals of one block.
const BLOCK: usize = 128;

const RICE_MAX: u32 = 13;
const ZERO_RUNS: u32 = 14;
const ALL_ZERO: u32 = 15;
/// A quotient of so many ones is an escape.
const ESCAPE: u64 = 24;

/// Writes the residuals block by block.
pub(super) fn write(writer: &mut BitWriter, residuals: &[i64]) {
    for block in residuals.chunks(BLOCK) {
        let (code, _) = best(block);
        writer.bits(u64::from(code), 4);
        match code {
            ALL_ZERO => {}
            ZERO_RUNS => write_runs(writer, block),
            k => block.iter().for_each(|r| write_rice(writer, zigzag(*r), k)),
        }
    }
}

/// How many bits [`write()`] would take.
pub(super) fn cost(residuals: &[i64]) -> u64 {
    residuals.chunks(BLOCK).map(|b| 4 + best(b).1).sum()
}

/// Bits that `count` residuals take at the very least: the blocks' code numbers.
pub(super) fn min_bits(count: usize) -> usize {
    count.div_ceil(BLOCK) * 4
}

/// Reads `count` residuals, giving each to `take`.
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

/// The code that takes the fewest bits, and those; the lowest of equals.
fn best(block: &[i64]) -> (u32, u64) {
    if block.iter().all(|r| *r == 0) {
        return (ALL_ZERO, 0);
    }
    let rice = (0..=RICE_MAX).map(|k| {
        let bits = block.iter().map(|r| rice_bits(zigzag(*r), k)).sum();
        (k, bits)
    });
    rice.chain([(ZERO_RUNS, runs_bits(block))])
        .min_by_key(|(_, bits)| *bits)
        .expect("there are fifteen codes to choose from")
}

fn rice_bits(code: u64, k: u32) -> u64 {
    let quotient = code >> k;
    if quotient < ESCAPE {
        quotient + 1 + u64::from(k)
    } else {
        ESCAPE + 6 + u64::from(bit_length(code))
    }
}

fn write_rice(writer: &mut BitWriter, code: u64, k: u32) {
    let quotient = code >> k;
    if quotient < ESCAPE {
        writer.bits(u64::MAX, quotient as u32);
        writer.bits(0, 1);
        writer.bits(code, k);
        return;
    }
    let length = bit_length(code);
    writer.bits(u64::MAX, ESCAPE as u32);
    writer.bits(u64::from(length - 1), 6);
    writer.bits(code, length);
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

/// Zeros before each other value, and the value, both in gamma code; a last run
/// that fills the block stands alone.
fn runs(block: &[i64]) -> Vec<(u64, Option<u64>)> {
    let mut found = Vec::new();
    let mut zeros = 0;
    for residual in block {
        if *residual == 0 {
            zeros += 1;
            continue;
        }
        found.push((zeros, Some(zigzag(*residual))));
        zeros = 0;
    }
    if zeros > 0 {
        found.push((zeros, None));
    }
    found
}

fn runs_bits(block: &[i64]) -> u64 {
    runs(block)
        .into_iter()
        .map(|(zeros, value)| gamma_bits(zeros + 1) + value.map_or(0, gamma_bits))
        .sum()
}

fn write_runs(writer: &mut BitWriter, block: &[i64]) {
    for (zeros, value) in runs(block) {
        writer.gamma(zeros + 1);
        if let Some(code) = value {
            writer.gamma(code);
        }
    }
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

/// Bits of the number itself; 1 for zero.
fn bit_length(value: u64) -> u32 {
    value.max(1).ilog2() + 1
}

fn gamma_bits(value: u64) -> u64 {
    u64::from(2 * bit_length(value) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_comes_back(residuals: &[i64]) -> u64 {
        let mut writer = BitWriter::default();
        write(&mut writer, residuals);
        let bytes = writer.into_bytes();
        assert_eq!((cost(residuals)).div_ceil(8), bytes.len() as u64);
        let mut found = Vec::new();
        let mut reader = BitReader::new(&bytes);
        read(&mut reader, residuals.len(), 1, |r| {
            found.push(r);
            Ok(())
        })
        .unwrap();
        assert_eq!(found, residuals);
        reader.finish().unwrap();
        cost(residuals)
    }

    #[test]
    fn every_kind_of_block_comes_back_at_the_stated_cost() {
        assert_eq!(assert_comes_back(&[0; 300]), 3 * 4);
        assert_eq!(assert_comes_back(&[1, -1, 0, 0]), 4 + 3 + 2 + 1 + 1);
        let mut sparse = [0; 128];
        sparse[100] = -70;
        // Seven zeros and seven bits of 101; the value's own code; the last 27.
        assert_eq!(assert_comes_back(&sparse), 4 + 13 + 15 + 9);
        let wide: Vec<i64> = (0..200).map(|i| (i * 7919) % 4001 - 2000).collect();
        assert_comes_back(&wide);
        assert_comes_back(&[3, -2, i64::MAX - 1, i64::MIN + 1, 1, i64::MIN, i64::MAX]);
        assert_eq!(assert_comes_back(&[]), 0);
    }

    #[test]
    fn a_run_beyond_the_block_is_refused() {
        let mut writer = BitWriter::default();
        writer.bits(14, 4);
        writer.gamma(6);
        let bytes = writer.into_bytes();
        let read = read(&mut BitReader::new(&bytes), 4, 9, |_| Ok(()));
        assert_eq!(read, Err(DecodeError::BadRun(9)));
    }
}
