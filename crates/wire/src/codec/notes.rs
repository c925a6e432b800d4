//! Notes in a frame: everything but the tally and the samples. Each states its
//! kind and length, so that a decoder skips unknown kinds.

use super::bits::{BitReader, BitWriter, unzigzag, zigzag};
use super::error::{DecodeError, EncodeError};
use crate::alert::{ShipAlert, ShipAlertState};
use crate::batch::Thinned;
use binnacle_compass::time::Timestamp;
use uuid::Uuid;

/// The most notes of one frame.
const NOTES_MAX: u64 = 255;
const ALERT: u64 = 1;
const THINNED: u64 = 2;
/// The first second of GPS time, and the first of the year 2100.
const TIME_RANGE_S: std::ops::Range<i64> = 315_964_800..4_102_444_800;
const TENTHS_PER_DEG: f64 = 10.0;
const HAS_GYRO: u64 = 1;
const HAS_SATELLITE: u64 = 2;

/// The contents of a frame's notes.
#[derive(Debug, Default)]
pub(super) struct Notes {
    pub(super) alerts: Vec<ShipAlert>,
    pub(super) thinned: Option<Thinned>,
}

/// Writes all notes; there is at least one.
pub(super) fn write(
    writer: &mut BitWriter,
    alerts: &[ShipAlert],
    thinned: Option<Thinned>,
) -> Result<(), EncodeError> {
    let count = alerts.len() as u64 + u64::from(thinned.is_some());
    if count > NOTES_MAX {
        return Err(EncodeError::TooManyAlerts(alerts.len()));
    }
    writer.varint(count);
    for alert in alerts {
        write_note(writer, ALERT, &encode_alert(alert)?);
    }
    if let Some(thinned) = thinned {
        let mut note = BitWriter::default();
        note.varint(thinned.samples);
        note.varint(thinned.windows);
        write_note(writer, THINNED, &note.into_bytes());
    }
    Ok(())
}

fn write_note(writer: &mut BitWriter, kind: u64, bytes: &[u8]) {
    writer.varint(kind);
    writer.varint(bytes.len() as u64);
    writer.bytes(bytes);
}

fn encode_alert(alert: &ShipAlert) -> Result<Vec<u8>, EncodeError> {
    let mut note = BitWriter::default();
    if alert.revision == 0 {
        return Err(EncodeError::Alert("revision"));
    }
    note.bytes(alert.id.as_bytes());
    note.varint(u64::from(alert.revision));
    let state = match alert.state {
        ShipAlertState::Open => 0,
        ShipAlertState::Agree => 1,
        ShipAlertState::NotJudged => 2,
    };
    note.bits(state, 8);
    for (field, time) in [("since", alert.since), ("at", alert.at)] {
        let seconds = time.micros().div_euclid(1_000_000);
        if !TIME_RANGE_S.contains(&seconds) {
            return Err(EncodeError::Alert(field));
        }
        note.varint(seconds.unsigned_abs());
    }
    let (gyro, satellite) = (alert.gyro_departure_deg, alert.satellite_departure_deg);
    let flag = |departure: Option<f64>, bit| if departure.is_some() { bit } else { 0 };
    note.bits(flag(gyro, HAS_GYRO) | flag(satellite, HAS_SATELLITE), 8);
    let departures = gyro.into_iter().chain(satellite);
    for departure in departures {
        note.varint(zigzag(tenths("departure", departure)?));
    }
    note.varint(tenths("limit_deg", alert.limit_deg.abs())?.unsigned_abs());
    note.varint(u64::from(alert.model_version));
    Ok(note.into_bytes())
}

fn tenths(field: &'static str, degrees: f64) -> Result<i64, EncodeError> {
    if !(-180.0..=180.0).contains(&degrees) {
        return Err(EncodeError::Alert(field));
    }
    Ok((degrees * TENTHS_PER_DEG).round() as i64)
}

/// Reads the notes of [`write()`], and skips fields that a later agent
/// appended.
pub(super) fn read(reader: &mut BitReader<'_>) -> Result<Notes, DecodeError> {
    let count = reader.varint()?;
    if count > NOTES_MAX {
        return Err(DecodeError::TooManyNotes(count));
    }
    let mut notes = Notes::default();
    for _ in 0..count {
        let kind = reader.varint()?;
        let length = usize::try_from(reader.varint()?).map_err(|_| DecodeError::Truncated)?;
        let bytes = reader.bytes(length)?;
        let mut note = BitReader::new(&bytes);
        match kind {
            ALERT => notes.alerts.push(read_alert(&mut note)?),
            THINNED if notes.thinned.is_some() => return Err(DecodeError::BadNote(kind)),
            THINNED => notes.thinned = Some(read_thinned(&mut note)?),
            _ => {}
        }
    }
    Ok(notes)
}

fn read_thinned(note: &mut BitReader<'_>) -> Result<Thinned, DecodeError> {
    let mut number = || note.varint().map_err(|_| DecodeError::BadNote(THINNED));
    Ok(Thinned {
        samples: number()?,
        windows: number()?,
    })
}

fn read_alert(note: &mut BitReader<'_>) -> Result<ShipAlert, DecodeError> {
    alert(note)
        .ok()
        .flatten()
        .ok_or(DecodeError::BadNote(ALERT))
}

fn alert(note: &mut BitReader<'_>) -> Result<Option<ShipAlert>, DecodeError> {
    let id = Uuid::from_u64_pair(note.bits(64)?, note.bits(64)?);
    let revision = note.varint()?;
    let state = match note.bits(8)? {
        0 => ShipAlertState::Open,
        1 => ShipAlertState::Agree,
        2 => ShipAlertState::NotJudged,
        _ => return Ok(None),
    };
    let (since, at) = (time(note.varint()?), time(note.varint()?));
    let present = note.bits(8)?;
    let mut departure = |bit| -> Result<Option<f64>, DecodeError> {
        if present & bit == 0 {
            return Ok(None);
        }
        Ok(Some(unzigzag(note.varint()?) as f64 / TENTHS_PER_DEG))
    };
    let (gyro, satellite) = (departure(HAS_GYRO)?, departure(HAS_SATELLITE)?);
    let limit_deg = note.varint()? as f64 / TENTHS_PER_DEG;
    let model_version = u32::try_from(note.varint()?);
    let angles = [gyro, satellite, Some(limit_deg)];
    let sound = angles.into_iter().flatten().all(|deg| deg.abs() <= 180.0);
    let (Ok(revision), Some(since), Some(at), Ok(model_version)) =
        (u32::try_from(revision), since, at, model_version)
    else {
        return Ok(None);
    };
    if revision == 0 || !sound {
        return Ok(None);
    }
    Ok(Some(ShipAlert {
        id,
        revision,
        state,
        since,
        at,
        gyro_departure_deg: gyro,
        satellite_departure_deg: satellite,
        limit_deg,
        model_version,
    }))
}

fn time(seconds: u64) -> Option<Timestamp> {
    let seconds = i64::try_from(seconds).ok()?;
    if !TIME_RANGE_S.contains(&seconds) {
        return None;
    }
    Timestamp::from_micros(seconds * 1_000_000).ok()
}
