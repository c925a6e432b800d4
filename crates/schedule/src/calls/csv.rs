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

use super::file_error::{FileError, FileErrors};
use super::{Located, PortCall};
use crate::ports::{self, PortCode};
use crate::time::Instant;
use std::collections::BTreeMap;
use std::io::{BufRead, Read, Write};

/// Maximum length of a line, bytes.
const MAX_LINE_BYTES: u64 = 4096;
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
    mut file: impl BufRead,
    vessel: Option<&str>,
    now: Instant,
    faults: &mut FileErrors,
) -> Result<Rows, FileError> {
    let (mut header, mut rows, mut line) = (None, Rows::default(), 0);
    let (mut separator, mut count) = (',', 0);
    let mut ids = BTreeMap::new();
    while let Some(text) = read_line(&mut file, line + 1)? {
        line += 1;
        if text.trim().is_empty() {
            continue;
        }
        let Some(header) = &header else {
            separator = find_separator(&text, line)?;
            header = Some(parse_header(split_cells(&text, separator, line)?, line)?);
            continue;
        };
        if count == MAX_CALLS {
            return Err(FileError::new(
                line,
                "row",
                format!("more than {MAX_CALLS} calls"),
            ));
        }
        let read = split_cells(&text, separator, line)
            .and_then(|cells| parse_row(header, &cells, separator, vessel, line))
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
    if header.is_none() {
        return Err(FileError::new(1, "row", "the file is empty"));
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

/// Returns true where a spreadsheet would read a formula.
fn is_formula(text: &str) -> bool {
    text.starts_with(['=', '+', '-', '@', '\t', '\r'])
}

/// Returns a cell that no spreadsheet reads as a formula.
pub fn escape_formula(text: &str) -> String {
    let apostrophes = text.trim_start_matches('\'');
    if is_formula(apostrophes) {
        format!("'{text}")
    } else {
        text.to_owned()
    }
}

/// Returns the cell before [`escape_formula`].
fn unescape_formula(text: &str) -> &str {
    match text.strip_prefix('\'') {
        Some(rest) if is_formula(rest.trim_start_matches('\'')) => rest,
        _ => text,
    }
}

fn read_line(file: &mut impl BufRead, line: usize) -> Result<Option<String>, FileError> {
    let failed = |what: String| FileError::new(line, "row", what);
    let mut bytes = Vec::new();
    let read = file
        .by_ref()
        .take(MAX_LINE_BYTES + 1)
        .read_until(b'\n', &mut bytes);
    read.map_err(|error| failed(error.to_string()))?;
    if bytes.is_empty() {
        return Ok(None);
    }
    if bytes.len() as u64 > MAX_LINE_BYTES {
        return Err(failed(format!("is longer than {MAX_LINE_BYTES} bytes")));
    }
    let text = String::from_utf8(bytes).map_err(|_| failed("is not UTF-8 text".to_owned()))?;
    let text = if line == 1 {
        text.trim_start_matches('\u{feff}')
    } else {
        &text
    };
    Ok(Some(text.to_owned()))
}

/// Finds the separator of a file by its first line: column names contain
/// neither.
fn find_separator(header: &str, line: usize) -> Result<char, FileError> {
    match (header.contains(','), header.contains(';')) {
        (true, true) => {
            let what = "has both commas and semicolons between its fields; use only one of them";
            Err(FileError::new(line, "row", what))
        }
        (false, true) => Ok(';'),
        (_, false) => Ok(','),
    }
}

/// Splits a line into cells, trimmed (RFC 4180, but for line ends within
/// quotes).
fn split_cells(text: &str, separator: char, line: usize) -> Result<Vec<String>, FileError> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    let mut letters = text.trim_end_matches(['\r', '\n']).chars().peekable();
    while let Some(letter) = letters.next() {
        let cell = cells.last_mut().expect("there is a first");
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => cell.extend(letters.next()),
            '"' => quoted = !quoted,
            _ if letter == separator && !quoted => cells.push(String::new()),
            _ => cell.push(letter),
        }
    }
    if quoted {
        return Err(FileError::new(
            line,
            "row",
            "a quote is not closed on its line",
        ));
    }
    Ok(cells.iter().map(|cell| cell.trim().to_owned()).collect())
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

fn parse_header(header: Vec<String>, line: usize) -> Result<Vec<String>, FileError> {
    for (at, name) in header.iter().enumerate() {
        if !COLUMNS.contains(&name.as_str()) {
            let what = format!("is not a column; known columns are {}", COLUMNS.join(", "));
            return Err(FileError::new(line, name, what));
        }
        if header[..at].contains(name) {
            return Err(FileError::new(line, name, "appears twice"));
        }
    }
    for needed in ["port", "eta", "etd"] {
        if !header.iter().any(|name| name == needed) {
            return Err(FileError::new(line, needed, "the column is missing"));
        }
    }
    Ok(header)
}

fn parse_row(
    header: &[String],
    cells: &[String],
    separator: char,
    vessel: Option<&str>,
    line: usize,
) -> Result<PortCall, FileError> {
    if cells.len() != header.len() {
        let what = format!(
            "{} fields, where the first line has {}",
            cells.len(),
            header.len()
        );
        return Err(FileError::new(line, "row", what));
    }
    let cell = |name: &str| {
        let at = header.iter().position(|column| column == name)?;
        Some(unescape_formula(&cells[at])).filter(|text| !text.is_empty())
    };
    let needed = |name: &str| cell(name).ok_or_else(|| FileError::new(line, name, "is empty"));
    let instant =
        |name: &str| parse_instant(needed(name)?).map_err(|what| FileError::new(line, name, what));
    // Where semicolons separate fields, a comma may be the decimal point.
    let read = |text: &str| match separator {
        ';' => text.replace(',', ".").parse::<f64>(),
        _ => text.parse::<f64>(),
    };
    let number = |name: &str| match cell(name).map(|text| (text, read(text))) {
        None => Ok(None),
        Some((_, Ok(number))) if number.is_finite() => Ok(Some(number)),
        Some((text, _)) => Err(FileError::new(
            line,
            name,
            format!("{text:?} is not a number"),
        )),
    };
    let port = find_port(needed("port")?).map_err(|what| FileError::new(line, "port", what))?;
    let (eta, etd) = (instant("eta")?, instant("etd")?);
    let vessel = cell("vessel").or(vessel);
    Ok(PortCall {
        id: cell("id").map_or_else(|| format!("{port} {eta}"), str::to_owned),
        name: None,
        vessel: vessel
            .ok_or_else(|| FileError::new(line, "vessel", "is empty"))?
            .to_owned(),
        port,
        berth: cell("berth").map(str::to_owned),
        eta,
        eta_uncertainty_h: number("eta_uncertainty_h")?.unwrap_or(0.0),
        etd,
        etd_uncertainty_h: number("etd_uncertainty_h")?.unwrap_or(0.0),
        berth_heading_deg: number("berth_heading_deg")?,
    })
}
