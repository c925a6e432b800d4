//! Input of the commands: options, JSON files and tables of samples.

use super::BadInput;
use binnacle_analysis::fit::{CsvRow, CsvRowError};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use csv::{ReaderBuilder, StringRecord};
use serde::de::DeserializeOwned;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Largest file that a command reads, bytes.
const MAX_FILE_BYTES: u64 = 256 * 1024 * 1024;

/// Parses an RFC 3339 time, a day (its noon, UTC) or a decimal year.
pub(super) fn date(text: &str) -> Result<Timestamp, BadInput> {
    let day = || Timestamp::parse(&format!("{text}T12:00:00Z")).ok();
    Timestamp::parse(text)
        .ok()
        .or_else(day)
        .or_else(|| decimal_year(text))
        .ok_or_else(|| {
            BadInput::option(
                "--date",
                format!("{text:?} is neither YYYY-MM-DD nor RFC 3339 nor a decimal year"),
            )
        })
}

fn decimal_year(text: &str) -> Option<Timestamp> {
    let year: f64 = text.parse().ok()?;
    if !(1.0..9999.0).contains(&year) {
        return None;
    }
    let start = |year: f64| Timestamp::parse(&format!("{year:04.0}-01-01T00:00:00Z")).ok();
    let (begins, ends) = (start(year.floor())?, start(year.floor() + 1.0)?);
    Some(begins.plus_seconds(ends.seconds_since(begins) * year.fract()))
}

/// Returns a position from two options.
pub(super) fn position(lat: f64, lon: f64) -> Result<Position, BadInput> {
    Position::new(lat, 0.0).map_err(|error| BadInput::option("--lat", error))?;
    Position::new(lat, lon).map_err(|error| BadInput::option("--lon", error))
}

/// Reads a JSON file.
pub(super) fn json_file<T: DeserializeOwned>(path: &Path) -> Result<T, BadInput> {
    let text = text_file(path)?;
    let mut json = serde_json::Deserializer::from_str(&text);
    let read = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let field = match error.path().to_string().as_str() {
            "." => String::new(),
            field => format!("{field}: "),
        };
        json_error(path, 0, &field, error.inner())
    })?;
    json.end()
        .map_err(|error| json_error(path, 0, "", &error))?;
    Ok(read)
}

/// Describes an error in JSON that begins some lines down a file, with its field.
pub(super) fn json_error(
    path: &Path,
    lines_before: usize,
    field: &str,
    error: &serde_json::Error,
) -> BadInput {
    // serde_json's message ends with the position, which is at the front here.
    let message = error.to_string();
    let what = message.split(" at line ").next().unwrap_or(&message);
    let line = lines_before + error.line().max(1);
    BadInput(format!("{}:{line}: {field}{what}", path.display()))
}

/// Reads a text file.
pub(super) fn text_file(path: &Path) -> Result<String, BadInput> {
    let failed = |error: &dyn std::fmt::Display| BadInput(format!("{}: {error}", path.display()));
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| failed(&error))?;
    BufReader::new(file)
        .take(MAX_FILE_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| failed(&error))?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(failed(&"the file is larger than 256 MB"));
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = valid.split(|byte| *byte == b'\n').count();
        BadInput(format!("{}:{line}: this is not text", path.display()))
    })
}

/// Table of samples, with the line number of each row in the file.
pub(super) struct Table {
    path: String,
    /// Rows of the table.
    pub(super) rows: Vec<CsvRow>,
    lines: Vec<u64>,
}

impl Table {
    /// Reads a CSV file whose first line names the columns.
    pub(super) fn read(path: &Path) -> Result<Table, BadInput> {
        let text = text_file(path)?;
        let path = path.display().to_string();
        if text.trim().is_empty() {
            return Err(BadInput(format!("{path}: the file is empty")));
        }
        let mut reader = ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let broken = |error: &csv::Error| {
            let line = error.position().map_or(1, csv::Position::line);
            let what = match error.kind() {
                csv::ErrorKind::UnequalLengths {
                    expected_len, len, ..
                } => format!("{len} fields, but the first line has {expected_len}"),
                _ => error.to_string(),
            };
            BadInput(format!("{path}:{line}: {what}"))
        };
        let header = reader.headers().map_err(|error| broken(&error))?.clone();
        check_header(&path, &header)?;
        let (mut rows, mut lines) = (Vec::new(), Vec::new());
        for record in reader.records() {
            let record = record.map_err(|error| broken(&error))?;
            let line = record.position().map_or(0, csv::Position::line);
            rows.push(
                row(&header, &record).map_err(|(column, what)| {
                    BadInput(format!("{path}:{line}: {column}: {what}"))
                })?,
            );
            lines.push(line);
        }
        if rows.is_empty() {
            let what = "there is no row after the column names in the first line";
            return Err(BadInput(format!("{path}: {what}")));
        }
        Ok(Table { path, rows, lines })
    }

    /// Returns an error about a row, with its line.
    pub(super) fn error_at(&self, error: &CsvRowError) -> BadInput {
        let line = error
            .row()
            .and_then(|row| self.lines.get(row))
            .unwrap_or(&1);
        BadInput(format!("{}:{line}: {error}", self.path))
    }

    /// Returns an error about a column of one row.
    pub(super) fn invalid(&self, row: usize, column: &'static str, message: String) -> BadInput {
        self.error_at(&CsvRowError::Invalid {
            row,
            column,
            message,
        })
    }
}

fn check_header(path: &str, header: &StringRecord) -> Result<(), BadInput> {
    let names: Vec<&str> = header.iter().collect();
    for (index, name) in names.iter().enumerate() {
        if names[..index].contains(name) {
            return Err(BadInput(format!("{path}:1: column {name} occurs twice")));
        }
    }
    binnacle_analysis::fit::check_columns(names)
        .map_err(|error| BadInput(format!("{path}:1: {error}")))
}

/// Known columns.
const COLUMNS: [&str; 22] = [
    "time",
    "lat",
    "lon",
    "variation_deg",
    "h_nt",
    "z_nt",
    "compass_deg",
    "gyro_deg",
    "satellite_deg",
    "reference_deg",
    "sog_kn",
    "cog_deg",
    "rate_of_turn_deg_min",
    "roll_deg",
    "roll_spread_deg",
    "temperature_c",
    "gyro_source",
    "satellite_source",
    "spread_deg",
    "windows",
    "weight",
    "position_reckoned",
];
/// Longest time or number, bytes; error messages quote it.
const LONGEST_VALUE: usize = 64;

/// Reads the known columns; others are ignored.
fn row(header: &StringRecord, record: &StringRecord) -> Result<CsvRow, (String, String)> {
    let mut row = CsvRow::default();
    for (column, text) in header.iter().zip(record) {
        let number = match column {
            _ if !COLUMNS.contains(&column) => continue,
            _ if text.len() > LONGEST_VALUE => {
                let what = format!("{} bytes are too long for a value", text.len());
                return Err((column.to_owned(), what));
            }
            "time" => {
                if !text.is_empty() {
                    let time = Timestamp::parse(text);
                    row.time = Some(time.map_err(|error| (column.to_owned(), error.to_string()))?);
                }
                continue;
            }
            "position_reckoned" => {
                let is_reckoned = parse_switch(text);
                row.position_reckoned =
                    is_reckoned.map_err(|problem| (column.to_owned(), problem))?;
                continue;
            }
            "lat" => &mut row.lat,
            "lon" => &mut row.lon,
            "variation_deg" => &mut row.variation_deg,
            "h_nt" => &mut row.h_nt,
            "z_nt" => &mut row.z_nt,
            "compass_deg" => &mut row.compass_deg,
            "gyro_deg" => &mut row.gyro_deg,
            "satellite_deg" => &mut row.satellite_deg,
            "reference_deg" => &mut row.reference_deg,
            "sog_kn" => &mut row.sog_kn,
            "cog_deg" => &mut row.cog_deg,
            "rate_of_turn_deg_min" => &mut row.rate_of_turn_deg_min,
            "roll_deg" => &mut row.roll_deg,
            "roll_spread_deg" => &mut row.roll_spread_deg,
            "temperature_c" => &mut row.temperature_c,
            "gyro_source" => &mut row.gyro_source,
            "satellite_source" => &mut row.satellite_source,
            "spread_deg" => &mut row.spread_deg,
            "windows" => &mut row.windows,
            "weight" => &mut row.weight,
            _ => continue,
        };
        *number = parse(text).map_err(|what| (column.to_owned(), what))?;
    }
    Ok(row)
}

/// Parses a number; an empty text gives `None`.
fn parse(text: &str) -> Result<Option<f64>, String> {
    if text.is_empty() {
        return Ok(None);
    }
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(Some(number)),
        _ => Err(format!("{text:?} is not a finite number")),
    }
}

/// Parses `true` or `false`; an empty text is false.
fn parse_switch(text: &str) -> Result<bool, String> {
    match text {
        "" | "false" => Ok(false),
        "true" => Ok(true),
        _ => Err(format!("{text:?} is neither true nor false")),
    }
}
