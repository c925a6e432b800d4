//! A column in a dense frame: presence, predictor, first value and residuals.
//! All are range-coded with adaptive bit models, which start afresh in each
//! column.

use super::bits::{unzigzag, zigzag};
use super::error::DecodeError;
use super::plain::bounded;
use super::predict::{Predictor, PredictorState};
use super::range::{BitModel, RangeReader, RangeWriter};

const PREDICTOR_BITS: u32 = 4;
/// Bits of the first value's length field.
const FIRST_LENGTH_BITS: u32 = 6;
/// Residuals lie within ±2⁵⁴: their lengths are 0 to 55.
const LONGEST: usize = 55;

/// Adaptive bit models of a column's residuals.
#[derive(Clone, Debug)]
struct ResidualModels {
    /// Models of "longer than this index?".
    longer: [BitModel; LONGEST],
    negative: BitModel,
    /// Models of the bit after the highest, by length.
    second: [BitModel; LONGEST + 1],
}

impl ResidualModels {
    const INITIAL: ResidualModels = ResidualModels {
        longer: [BitModel::INITIAL; LONGEST],
        negative: BitModel::INITIAL,
        second: [BitModel::INITIAL; LONGEST + 1],
    };

    fn write(&mut self, writer: &mut RangeWriter, residual: i64) {
        let size = residual.unsigned_abs();
        let length = (u64::BITS - size.leading_zeros()) as usize;
        for (at, model) in self.longer.iter_mut().enumerate().take(length + 1) {
            writer.modelled_bit(model, length > at);
        }
        if length == 0 {
            return;
        }
        writer.modelled_bit(&mut self.negative, residual < 0);
        if length > 1 {
            let second = size >> (length - 2) & 1;
            writer.modelled_bit(&mut self.second[length], second == 1);
            writer.bits(size, length as u32 - 2);
        }
    }

    fn read(&mut self, reader: &mut RangeReader<'_>) -> Result<i64, DecodeError> {
        let mut length = 0;
        while length < LONGEST && reader.modelled_bit(&mut self.longer[length])? {
            length += 1;
        }
        if length == 0 {
            return Ok(0);
        }
        let is_negative = reader.modelled_bit(&mut self.negative)?;
        let mut size = 1;
        if length > 1 {
            size = size << 1 | u64::from(reader.modelled_bit(&mut self.second[length])?);
            size = size << (length - 2) | reader.bits(length as u32 - 2)?;
        }
        let size = size.cast_signed();
        Ok(if is_negative { -size } else { size })
    }
}

/// Writes a column's values. `times` has the times of the same samples, and is
/// `None` for the column of times itself.
pub(super) fn write(writer: &mut RangeWriter, values: &[Option<i64>], times: Option<&[i64]>) {
    write_presence(writer, values);
    let present: Vec<(i64, i64)> = values
        .iter()
        .enumerate()
        .filter_map(|(row, value)| value.map(|v| (v, times.map_or(0, |times| times[row]))))
        .collect();
    let Some((first, _)) = present.first() else {
        return;
    };
    let (number, residuals) = (0..Predictor::ALL.len())
        .filter(|number| times.is_some() || !Predictor::ALL[*number].needs_times())
        .map(|number| (number, residuals(Predictor::ALL[number], &present)))
        .min_by_key(|(_, residuals)| cost(residuals))
        .expect("there are predictors to choose from");
    writer.bits(number as u64, PREDICTOR_BITS);
    let first = zigzag(*first);
    let length = u64::BITS - first.leading_zeros();
    writer.bits(u64::from(length), FIRST_LENGTH_BITS);
    writer.bits(first, length.saturating_sub(1));
    let mut models = ResidualModels::INITIAL;
    for residual in residuals {
        models.write(writer, residual);
    }
}

fn residuals(predictor: Predictor, present: &[(i64, i64)]) -> Vec<i64> {
    let mut state = PredictorState::new(predictor, present[0].0, present[0].1);
    present[1..]
        .iter()
        .map(|(value, time)| {
            let residual = value - state.predict(*time);
            state.update(*value, *time);
            residual
        })
        .collect()
}

/// Approximate size of the residuals in bits, for the choice of a predictor.
fn cost(residuals: &[i64]) -> u64 {
    let (mut writer, mut models) = (RangeWriter::new(), ResidualModels::INITIAL);
    for residual in residuals {
        models.write(&mut writer, *residual);
    }
    writer.bits_written()
}

/// Reads a column of `count` samples. `times` is `None` for the column of times
/// itself, which cannot be predicted from them.
pub(super) fn read(
    reader: &mut RangeReader<'_>,
    id: u64,
    count: usize,
    times: Option<&[i64]>,
) -> Result<Vec<Option<i64>>, DecodeError> {
    let presence = read_presence(reader, count)?;
    let mut rows = (0..count).filter(|row| presence.as_ref().is_none_or(|p| p[*row]));
    let mut values = vec![None; count];
    let Some(first_row) = rows.next() else {
        return Ok(values);
    };
    let predictor = Predictor::ALL.get(reader.bits(PREDICTOR_BITS)? as usize);
    let predictor = predictor
        .copied()
        .filter(|predictor| times.is_some() || !predictor.needs_times())
        .ok_or(DecodeError::BadPredictor(id))?;
    let time = |row: usize| times.map_or(0, |times| times[row]);
    let first = bounded(unzigzag(read_first(reader)?), id, first_row)?;
    values[first_row] = Some(first);
    let mut state = PredictorState::new(predictor, first, time(first_row));
    let mut models = ResidualModels::INITIAL;
    for row in rows {
        let value = state.predict(time(row)) + models.read(reader)?;
        values[row] = Some(bounded(value, id, row)?);
        state.update(value, time(row));
    }
    Ok(values)
}

fn read_first(reader: &mut RangeReader<'_>) -> Result<u64, DecodeError> {
    let length = reader.bits(FIRST_LENGTH_BITS)? as u32;
    if length == 0 {
        return Ok(0);
    }
    Ok(1 << (length - 1) | reader.bits(length - 1)?)
}

/// Writes one bit for "all present"; otherwise one bit per value, modelled by
/// the presence of the value before.
fn write_presence(writer: &mut RangeWriter, values: &[Option<i64>]) {
    let is_whole = values.iter().all(Option::is_some);
    writer.bits(u64::from(!is_whole), 1);
    if is_whole {
        return;
    }
    let (mut model, mut before) = ([BitModel::INITIAL; 2], true);
    for value in values {
        writer.modelled_bit(&mut model[usize::from(before)], value.is_some());
        before = value.is_some();
    }
}

/// Reads the presence of each value; `None` when every sample has one.
fn read_presence(
    reader: &mut RangeReader<'_>,
    count: usize,
) -> Result<Option<Vec<bool>>, DecodeError> {
    if reader.bits(1)? == 0 {
        return Ok(None);
    }
    let (mut model, mut before) = ([BitModel::INITIAL; 2], true);
    let mut presence = Vec::with_capacity(count);
    for _ in 0..count {
        before = reader.modelled_bit(&mut model[usize::from(before)])?;
        presence.push(before);
    }
    Ok(Some(presence))
}
