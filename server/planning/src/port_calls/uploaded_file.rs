//! Uploaded files of port calls: read within limits, and compared with the stored calls.

use super::call::{Content, Source};
use super::store::StoredCall;
use axum::body::Body;
use binnacle_fleet::vessels::VesselNames;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::VesselId;
use binnacle_platform::time::Time;
use binnacle_schedule::calls::{FileError, FileErrors, Located, find_overlaps};
use futures_util::StreamExt;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum size of a file, bytes.
pub(super) const MAX_BYTES: usize = 8 * 1024 * 1024;
/// Maximum number of bytes read of a file that is too large. The sender must finish sending to
/// receive the refusal.
const MAX_DRAINED_BYTES: usize = 128 * 1024 * 1024;

/// Reads a whole body.
///
/// # Errors
/// Fails with [`Error::TooLarge`] when it is larger than [`MAX_BYTES`].
pub(super) async fn read_body(body: Body) -> Result<Vec<u8>> {
    let (mut bytes, mut received) = (Vec::new(), 0);
    let mut chunks = body.into_data_stream();
    while let Some(chunk) = chunks.next().await {
        let chunk = chunk.map_err(|error| Error::BadRequest(error.to_string()))?;
        received += chunk.len();
        if received <= MAX_BYTES {
            bytes.extend_from_slice(&chunk);
        } else if received > MAX_DRAINED_BYTES {
            break;
        }
    }
    if received > MAX_BYTES {
        return Err(Error::TooLarge(MAX_BYTES));
    }
    Ok(bytes)
}

/// Changes that a file makes to the calls of one vessel.
#[derive(Default)]
pub(super) struct FileChanges<'a> {
    pub(super) new: Vec<Content>,
    pub(super) amended: Vec<AmendedCall<'a>>,
    pub(super) unchanged: usize,
    pub(super) withdrawn: Vec<WithdrawnCall<'a>>,
}

/// Stored call that a file amends.
pub(super) struct AmendedCall<'a> {
    pub(super) stored: &'a StoredCall,
    pub(super) content: Content,
}

/// Stored call that a file withdraws.
pub(super) struct WithdrawnCall<'a> {
    pub(super) stored: &'a StoredCall,
    pub(super) reason: &'static str,
}

/// Call on a line of a file.
pub(super) struct CallOnLine {
    line: usize,
    content: Content,
}

/// Calls of one vessel in a file.
#[derive(Default)]
pub(super) struct VesselCalls {
    pub(super) calls: Vec<CallOnLine>,
    pub(super) cancelled: BTreeSet<String>,
}

impl VesselCalls {
    /// Adds a call that stands on no line of a file.
    pub(super) fn add(&mut self, content: Content) {
        self.calls.push(CallOnLine { line: 1, content });
    }

    /// Adds a call of the file.
    pub(super) fn push(
        &mut self,
        located: Located,
        now: Time,
        errors: &mut FileErrors,
    ) -> Result<()> {
        let line = located.line;
        match Content::from_file(located.call).checked(now) {
            Ok(content) => self.calls.push(CallOnLine { line, content }),
            Err(Error::Invalid { field, detail }) => {
                errors.push(FileError::new(line, field, detail));
            }
            Err(other) => return Err(other),
        }
        Ok(())
    }

    /// Compares the file with the stored calls. A file that replaces earlier ones withdraws their
    /// calls that are not over and missing in it. Calls that overlap go into `errors`.
    pub(super) fn compare<'a>(
        self,
        known: &'a [StoredCall],
        source: Source,
        replaces: bool,
        now: Time,
        errors: &mut FileErrors,
    ) -> Result<FileChanges<'a>> {
        let lines: BTreeMap<String, usize> = self
            .calls
            .iter()
            .map(|call| (call.content.reference.clone(), call.line))
            .collect();
        let withdrawal_reason = |row: &StoredCall| {
            if self.cancelled.contains(&row.reference) {
                return Some("cancelled in the file");
            }
            let is_left_out = replaces && row.source == source && row.etd > now;
            is_left_out.then_some("no longer in the file")
        };
        let by_reference: BTreeMap<&str, &StoredCall> = known
            .iter()
            .map(|row| (row.reference.as_str(), row))
            .collect();
        let mut changes = FileChanges::default();
        let mut calls = Vec::new();
        for row in known.iter().filter(|row| row.withdrawn_at.is_none()) {
            if lines.contains_key(&row.reference) {
                continue;
            }
            match withdrawal_reason(row) {
                Some(reason) => changes.withdrawn.push(WithdrawnCall {
                    stored: row,
                    reason,
                }),
                None => calls.push(row.content()?.to_schedule_call(&row.reference, "")),
            }
        }
        for CallOnLine { content: call, .. } in self.calls {
            calls.push(call.to_schedule_call(&call.reference, ""));
            match by_reference.get(call.reference.as_str()).copied() {
                None => changes.new.push(call),
                Some(row) if row.withdrawn_at.is_none() && row.content()? == call => {
                    changes.unchanged += 1;
                }
                Some(stored) => changes.amended.push(AmendedCall {
                    stored,
                    content: call,
                }),
            }
        }
        for (later, earlier) in find_overlaps(&calls) {
            let in_file = |at: usize| lines.get(&calls[at].id).copied();
            let (own, other) = match in_file(later) {
                Some(_) => (later, earlier),
                None => (earlier, later),
            };
            let other = &calls[other];
            let detail = format!(
                "overlaps call {:?} of the same vessel, from {} to {}",
                other.id, other.eta, other.etd
            );
            errors.push(FileError::new(in_file(own).unwrap_or(1), "eta", detail));
        }
        Ok(changes)
    }
}

/// Groups the rows of a file by vessel, named by id, IMO number or name. Invalid rows go into
/// `errors`.
pub(super) fn group_by_vessel(
    calls: Vec<Located>,
    fleet: &[VesselNames],
    now: Time,
    errors: &mut FileErrors,
) -> Result<BTreeMap<VesselId, VesselCalls>> {
    let mut named: BTreeMap<String, Vec<VesselId>> = BTreeMap::new();
    for vessel in fleet {
        let names = [
            Some(vessel.id.to_string()),
            Some(vessel.name.to_lowercase()),
            vessel.imo_number.clone(),
        ];
        for name in names.into_iter().flatten() {
            named.entry(name).or_default().push(vessel.id);
        }
    }
    let mut found: BTreeMap<VesselId, VesselCalls> = BTreeMap::new();
    let mut seen: BTreeMap<(VesselId, String), usize> = BTreeMap::new();
    for located in calls {
        let (line, name) = (located.line, located.call.vessel.clone());
        let vessel = match named.get(&name.to_lowercase()).map(Vec::as_slice) {
            Some([vessel]) => *vessel,
            Some(_) => {
                let detail =
                    format!("{name:?} matches several vessels; use the IMO number or the id");
                errors.push(FileError::new(line, "vessel", detail));
                continue;
            }
            None => {
                let detail = format!("there is no vessel {name:?}");
                errors.push(FileError::new(line, "vessel", detail));
                continue;
            }
        };
        // One vessel may be named in two ways.
        if let Some(first) = seen.insert((vessel, located.call.id.clone()), line) {
            let detail = format!("{:?} is already on line {first}", located.call.id);
            errors.push(FileError::new(line, "id", detail));
            continue;
        }
        let of_vessel = found.entry(vessel).or_default();
        of_vessel.push(located, now, errors)?;
    }
    Ok(found)
}

#[allow(
    clippy::needless_pass_by_value,
    reason = "it is what map_err hands over"
)]
/// Returns the refusal of a file, with its errors.
pub(super) fn refuse_file(errors: FileErrors) -> Error {
    Error::Invalid {
        field: "file",
        detail: errors.to_string(),
    }
}

/// Returns the refusal of a file that cannot be parsed.
pub(super) fn refuse_unreadable(error: FileError) -> Error {
    refuse_file(FileErrors::from(error))
}
