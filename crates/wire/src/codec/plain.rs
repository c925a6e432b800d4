//! A column in a plain frame, written by agents before dense frames: presence,
//! predictor, first value and residuals.

use super::bits::{BitReader, unzigzag};
use super::error::DecodeError;
use super::predict::{Predictor, PredictorState, VALUE_LIMIT};
use super::rice;

/// The least number of bits of a column without gaps.
pub(super) fn min_bits(count: usize) -> usize {
    // Presence, predictor, first value, the blocks' codes.
    1 + 3 + 8 + rice::min_bits(count.saturating_sub(1))
}

/// Reads a column of `count` samples. `times` is `None` for the column of times
/// itself, which cannot be predicted from them.
pub(super) fn read(
    reader: &mut BitReader<'_>,
    id: u64,
    count: usize,
    times: Option<&[i64]>,
) -> Result<Vec<Option<i64>>, DecodeError> {
    let presence = read_presence(reader, id, count)?;
    let mut rows = (0..count).filter(|row| presence.as_ref().is_none_or(|p| p[*row]));
    let mut values = vec![None; count];
    let Some(first_row) = rows.next() else {
        return Ok(values);
    };
    let predictor = Predictor::ALL[reader.bits(3)? as usize];
    if predictor.needs_times() && times.is_none() {
        return Err(DecodeError::BadPredictor(id));
    }
    let time = |row: usize| times.map_or(0, |times| times[row]);
    let first = bounded(unzigzag(reader.varint()?), id, first_row)?;
    values[first_row] = Some(first);
    let mut state = PredictorState::new(predictor, first, time(first_row));
    let left = presence
        .as_ref()
        .map_or(count, |p| p.iter().filter(|p| **p).count())
        - 1;
    rice::read(reader, left, id, |residual| {
        let row = rows.next().ok_or(DecodeError::BadRun(id))?;
        let value = state.predict(time(row)).saturating_add(residual);
        values[row] = Some(bounded(value, id, row)?);
        state.update(value, time(row));
        Ok(())
    })?;
    Ok(values)
}

pub(super) fn bounded(value: i64, column: u64, row: usize) -> Result<i64, DecodeError> {
    if (-VALUE_LIMIT..=VALUE_LIMIT).contains(&value) {
        return Ok(value);
    }
    Err(DecodeError::OutOfRange { row, column })
}

/// Reads the presence of each value; `None` when every sample has one.
fn read_presence(
    reader: &mut BitReader<'_>,
    id: u64,
    count: usize,
) -> Result<Option<Vec<bool>>, DecodeError> {
    if !reader.bit()? {
        return Ok(None);
    }
    let mut presence = Vec::with_capacity(count);
    let mut present = true;
    while presence.len() < count {
        let run = reader.gamma()? - 1;
        if run > (count - presence.len()) as u64 {
            return Err(DecodeError::BadRun(id));
        }
        presence.resize(presence.len() + run as usize, present);
        present = !present;
    }
    Ok(Some(presence))
}
