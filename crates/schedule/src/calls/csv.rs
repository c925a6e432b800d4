//! Reads and writes port calls as CSV.
//!
//! The first line names the columns: `id`, `vessel`, `port`, `eta`, `etd`, and
//! optionally `berth`, `eta_uncertainty_h`, `etd_uncertainty_h`,
//! `berth_heading_deg`. A file for one ship needs no `vessel`, and a call
//! without `id` is named after its port and ETA. A port stands by its UN/LOCODE
//! or its name. A time may leave out its seconds, but not its zone. Fields are
//! separated by commas, or by semicolons with decimal commas, as spreadsheets of much of
//! Europe write them. Past calls are left out and counted.
//!
//! Invariants: memory is bounded by one line and the calls read, however large
//! the file. Every fault is reported with its line and column. A written file
//! opens in a spreadsheet without formulas, and reads back unchanged.

use super::csv_rows::{CsvRow, CsvRows, escape_formula};
use super::file_error::{FileError, FileErrors};
use super::{Located, PortCall};
use crate::ports::{self, PortCode};
use crate::time::Instant;
use std::collections::BTreeMap;
use std::io::{BufRead, Write};

/// Maximum number of calls of a file.
pub const MAX_CALLS: usize = 50_000;

const COLUMNS: [&str; 9] = [
    "id",
    "vessel",
    "port",
    "berth",
    "eta",
    "eta_uncertainty_h",
    "etd",
    "etd_uncertainty_h",
    "berth_heading_deg",
];

/// The contents of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// The calls that are not over.
    pub calls: Vec<Located>,
    /// Number of past calls, which exporting programs keep for a while; they
    /// are left out.
    pub over: usize,
}

/// Reads a file's calls; `vessel` is the ship of rows that name none. Every row
/// is read, and each fault is added to `faults`, beside other faults of the
/// file.
///
/// # Errors
/// [`FileError`] where reading cannot go on: the first line names no columns, a
/// line is not text or too long, or there are too many rows.
pub fn read(
    file: impl BufRead,
    vessel: Option<&str>,
    now: Instant,
    faults: &mut FileErrors,
) -> Result<Rows, FileError> {
    let mut rows = Rows::default();
    let mut count = 0;
    let mut ids = BTreeMap::new();
    let mut file = CsvRows::open(file, &COLUMNS, &["port", "eta", "etd"])?;
    while let Some(row) = file.next_row()? {
        let line = match &row {
            Ok(row) => row.line,
            Err(fault) => fault.line,
        };
        if count == MAX_CALLS {
            let what = format!("more than {MAX_CALLS} calls");
            return Err(FileError::new(line, "row", what));
        }
        let read = row
            .and_then(|row| parse_row(&row, vessel))
            .and_then(|call| check_call(call, now, line))
            .and_then(|call| match call {
                Some(call) => check_id(&mut ids, &call, line).map(|()| Some(call)),
                None => Ok(None),
            });
        // Past calls are left out, however many.
        count += usize::from(!matches!(read, Ok(None)));
        match read {
            Ok(Some(call)) => rows.calls.push(Located { line, call }),
            Ok(None) => rows.over += 1,
            Err(fault) => faults.push(fault),
        }
    }
    Ok(rows)
}

/// Checks a call; `None` for a past one.
fn check_call(call: PortCall, now: Instant, line: usize) -> Result<Option<PortCall>, FileError> {
    if call.eta < call.etd && call.etd <= now {
        return Ok(None);
    }
    let checked = call.checked(now).and_then(|()| call.check_horizon(now));
    checked.map_err(|error| FileError::new(line, error.field, error.detail))?;
    Ok(Some(call))
}

/// Checks that the call's id is new for its ship.
pub(super) fn check_id(
    ids: &mut BTreeMap<(String, String), usize>,
    call: &PortCall,
    line: usize,
) -> Result<(), FileError> {
    match ids.insert((call.vessel.clone(), call.id.clone()), line) {
        None => Ok(()),
        Some(first) => {
            let what = format!("{:?} is already on line {first}", call.id);
            Err(FileError::new(line, "id", what))
        }
    }
}

/// Writes calls, after the line of column names.
///
/// # Errors
/// Fails when the writer fails.
pub fn write(calls: &[PortCall], out: impl Write) -> std::io::Result<()> {
    let mut out = csv::Writer::from_writer(out);
    out.write_record(COLUMNS)?;
    for call in calls {
        let heading = call
            .berth_heading_deg
            .map_or(String::new(), |heading| heading.to_string());
        let cells = [
            call.id.clone(),
            call.vessel.clone(),
            call.port.to_string(),
            call.berth.clone().unwrap_or_default(),
            call.eta.to_string(),
            call.eta_uncertainty_h.to_string(),
            call.etd.to_string(),
            call.etd_uncertainty_h.to_string(),
            heading,
        ];
        out.write_record(cells.map(|cell| escape_formula(&cell)))?;
    }
    out.flush()
}

/// Parses an instant, whose seconds may be left out and whose date and time a blank may separate.
fn parse_instant(text: &str) -> Result<Instant, String> {
    let mut written = text.to_owned();
    if text.is_char_boundary(16) && text.as_bytes().get(13) == Some(&b':') {
        let (minutes, rest) = text.split_at(16);
        let seconds = if rest.starts_with(':') { "" } else { ":00" };
        written = format!("{}{seconds}{rest}", minutes.replacen(' ', "T", 1));
    }
    Instant::parse(&written).map_err(|error| error.to_string().replace(&written, text))
}

/// Finds the port that a cell names, by its code or its name.
fn find_port(text: &str) -> Result<PortCode, String> {
    match ports::named(text)[..] {
        [port] => Ok(port.code),
        [] => Err(PortCode::parse(text).map_or_else(
            |_| format!("{text:?} is neither a UN/LOCODE, as NLRTM, nor the name of a sea port"),
            ports::describe_unknown,
        )),
        ref several => {
            let codes: Vec<String> = several.iter().map(|port| port.code.to_string()).collect();
            let codes = codes.join(", ");
            Err(format!(
                "{text:?} is the name of several ports ({codes}): write the code"
            ))
        }
    }
}

fn parse_row(row: &CsvRow<'_>, vessel: Option<&str>) -> Result<PortCall, FileError> {
    let fault = |name: &str, what: String| FileError::new(row.line, name, what);
    let needed = |name: &str| {
        let cell = row.cell(name);
        cell.ok_or_else(|| fault(name, "is empty".to_owned()))
    };
    let instant = |name: &str| parse_instant(needed(name)?).map_err(|what| fault(name, what));
    let port = find_port(needed("port")?).map_err(|what| fault("port", what))?;
    let (eta, etd) = (instant("eta")?, instant("etd")?);
    let vessel = match (row.cell("vessel"), vessel) {
        (Some(named), _) | (None, Some(named)) => named,
        (None, None) => needed("vessel")?,
    };
    Ok(PortCall {
        id: row
            .cell("id")
            .map_or_else(|| format!("{port} {eta}"), str::to_owned),
        name: None,
        vessel: vessel.to_owned(),
        port,
        berth: row.cell("berth").map(str::to_owned),
        eta,
        eta_uncertainty_h: row.number("eta_uncertainty_h")?.unwrap_or(0.0),
        etd,
        etd_uncertainty_h: row.number("etd_uncertainty_h")?.unwrap_or(0.0),
        berth_heading_deg: row.number("berth_heading_deg")?,
    })
}
