//! Files of port calls on their way in: read within bounds, and held against what is
//! known already.

use super::call::{Content, Source};
use super::store::Row;
use axum::body::Body;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::VesselId;
use binnacle_platform::time::Time;
use binnacle_schedule::calls::{FileError, FileErrors, Located, overlaps};
use futures_util::StreamExt;
use std::collections::{BTreeMap, BTreeSet};

/// No file is larger, in bytes.
pub(super) const MAX_BYTES: usize = 8 * 1024 * 1024;
/// Up to here a file that is too large is heard out, so that whoever sends it hears why
/// it is not taken.
const HEARD_BYTES: usize = 128 * 1024 * 1024;

/// A body's bytes.
///
/// # Errors
/// [`Error::TooLarge`] when there are too many of them.
pub(super) async fn whole(body: Body) -> Result<Vec<u8>> {
    let (mut bytes, mut heard) = (Vec::new(), 0);
    let mut chunks = body.into_data_stream();
    while let Some(chunk) = chunks.next().await {
        let chunk = chunk.map_err(|error| Error::BadRequest(error.to_string()))?;
        heard += chunk.len();
        if heard <= MAX_BYTES {
            bytes.extend_from_slice(&chunk);
        } else if heard > HEARD_BYTES {
            break;
        }
    }
    if heard > MAX_BYTES {
        return Err(Error::TooLarge(MAX_BYTES));
    }
    Ok(bytes)
}

/// Effect of a file on the calls of one vessel.
#[derive(Default)]
pub(super) struct Taken<'a> {
    pub(super) new: Vec<Content>,
    pub(super) amended: Vec<(&'a Row, Content)>,
    pub(super) unchanged: usize,
    /// And why.
    pub(super) withdrawn: Vec<(&'a Row, &'static str)>,
}

/// Calls of one vessel in a file.
#[derive(Default)]
pub(super) struct OfVessel {
    pub(super) calls: Vec<(usize, Content)>,
    pub(super) cancelled: BTreeSet<String>,
}

impl OfVessel {
    /// Takes a call from a file.
    pub(super) fn push(
        &mut self,
        located: Located,
        now: Time,
        faults: &mut FileErrors,
    ) -> Result<()> {
        let line = located.line;
        match Content::from_file(located.call).checked(now) {
            Ok(content) => self.calls.push((line, content)),
            Err(Error::Invalid { field, detail }) => {
                faults.push(FileError::new(line, field, detail));
            }
            Err(other) => return Err(other),
        }
        Ok(())
    }

    /// Holds the file against what is known. What came from such a file before, is not
    /// over and is not in this one is withdrawn if the file replaces it. Calls that
    /// overlap go into `faults`.
    pub(super) fn against<'a>(
        self,
        known: &'a [Row],
        source: Source,
        replaces: bool,
        now: Time,
        faults: &mut FileErrors,
    ) -> Result<Taken<'a>> {
        let lines: BTreeMap<String, usize> = self
            .calls
            .iter()
            .map(|(line, call)| (call.reference.clone(), *line))
            .collect();
        let why_gone = |row: &Row| {
            if self.cancelled.contains(&row.reference) {
                return Some("cancelled in the file");
            }
            let is_left_out = replaces && row.source == source && row.etd > now;
            is_left_out.then_some("not in the file any more")
        };
        let named: BTreeMap<&str, &Row> = known
            .iter()
            .map(|row| (row.reference.as_str(), row))
            .collect();
        let mut taken = Taken::default();
        let mut calls = Vec::new();
        for row in known.iter().filter(|row| row.withdrawn_at.is_none()) {
            if lines.contains_key(&row.reference) {
                continue;
            }
            match why_gone(row) {
                Some(why) => taken.withdrawn.push((row, why)),
                None => calls.push(row.content()?.of(&row.reference, "")),
            }
        }
        for (_, call) in self.calls {
            calls.push(call.of(&call.reference, ""));
            match named.get(call.reference.as_str()).copied() {
                None => taken.new.push(call),
                Some(row) if row.withdrawn_at.is_none() && row.content()? == call => {
                    taken.unchanged += 1;
                }
                Some(row) => taken.amended.push((row, call)),
            }
        }
        for (later, earlier) in overlaps(&calls) {
            let in_file = |at: usize| lines.get(&calls[at].id).copied();
            let (own, other) = match in_file(later) {
                Some(_) => (later, earlier),
                None => (earlier, later),
            };
            let other = &calls[other];
            let what = format!(
                "overlaps call {:?} of the same vessel, from {} to {}",
                other.id, other.eta, other.etd
            );
            faults.push(FileError::new(in_file(own).unwrap_or(1), "eta", what));
        }
        Ok(taken)
    }
}

/// Rows of a file by the vessel that each names: by her id, her IMO number or her name. What is
/// wrong with a row goes into `faults`.
pub(super) fn by_vessel(
    calls: Vec<Located>,
    fleet: &[(VesselId, String, Option<String>)],
    now: Time,
    faults: &mut FileErrors,
) -> Result<BTreeMap<VesselId, OfVessel>> {
    let mut named: BTreeMap<String, Vec<VesselId>> = BTreeMap::new();
    for (id, name, imo_number) in fleet {
        let names = [
            Some(id.to_string()),
            Some(name.to_lowercase()),
            imo_number.clone(),
        ];
        for name in names.into_iter().flatten() {
            named.entry(name).or_default().push(*id);
        }
    }
    let mut found: BTreeMap<VesselId, OfVessel> = BTreeMap::new();
    let mut seen: BTreeMap<(VesselId, String), usize> = BTreeMap::new();
    for located in calls {
        let (line, name) = (located.line, located.call.vessel.clone());
        let vessel = match named.get(&name.to_lowercase()).map(Vec::as_slice) {
            Some([vessel]) => *vessel,
            Some(_) => {
                let what = format!("{name:?} are several vessels; write the IMO number or the id");
                faults.push(FileError::new(line, "vessel", what));
                continue;
            }
            None => {
                let what = format!("there is no vessel {name:?}");
                faults.push(FileError::new(line, "vessel", what));
                continue;
            }
        };
        // One vessel may be named in two ways.
        if let Some(first) = seen.insert((vessel, located.call.id.clone()), line) {
            let what = format!("{:?} stands on line {first} already", located.call.id);
            faults.push(FileError::new(line, "id", what));
            continue;
        }
        let hers = found.entry(vessel).or_default();
        hers.push(located, now, faults)?;
    }
    Ok(found)
}

#[allow(
    clippy::needless_pass_by_value,
    reason = "it is what map_err hands over"
)]
/// Refusal of a file with mistakes, each named.
pub(super) fn invalid_file(faults: FileErrors) -> Error {
    Error::Invalid {
        field: "file",
        detail: faults.to_string(),
    }
}

/// Refusal of a file that cannot be read.
pub(super) fn unreadable_file(fault: FileError) -> Error {
    invalid_file(FileErrors::from(fault))
}
