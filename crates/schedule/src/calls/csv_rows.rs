//! Rows of a CSV file whose first line names its columns, as people and spreadsheets write them.
//!
//! Fields are separated by commas, or by semicolons (RFC 4180, but for line ends within quotes).
//!
//! Invariants: memory is bounded by one line, however large the file. Lines are counted as an editor
//! counts them, blank ones included.

use super::file_error::FileError;
use std::io::{BufRead, Read};

/// Maximum length of a line, bytes.
const MAX_LINE_BYTES: u64 = 4096;

/// A file that is read row by row.
#[derive(Debug)]
pub struct CsvRows<R> {
    file: R,
    line: usize,
    separator: char,
    columns: Vec<String>,
}

/// A row of a file.
#[derive(Debug)]
pub struct CsvRow<'a> {
    /// The line, from 1.
    pub line: usize,
    columns: &'a [String],
    cells: Vec<String>,
    separator: char,
}

impl<R: BufRead> CsvRows<R> {
    /// Reads the column names: each is `known`, none stands twice, and those `needed` are there.
    ///
    /// # Errors
    /// [`FileError`] where there are no such columns, or the line cannot be read.
    pub fn open(file: R, known: &[&str], needed: &[&str]) -> Result<CsvRows<R>, FileError> {
        let mut rows = CsvRows {
            file,
            line: 0,
            separator: ',',
            columns: Vec::new(),
        };
        let Some(header) = rows.next_line()? else {
            return Err(FileError::new(1, "row", "the file is empty"));
        };
        rows.separator = find_separator(&header, rows.line)?;
        rows.columns = split_cells(&header, rows.separator, rows.line)?;
        check_columns(&rows.columns, rows.line, known, needed)?;
        Ok(rows)
    }

    /// Returns the next row, or its fault; none at the end of the file.
    ///
    /// # Errors
    /// [`FileError`] where reading cannot go on: a line is not text, or too long.
    pub fn next_row(&mut self) -> Result<Option<Result<CsvRow<'_>, FileError>>, FileError> {
        let Some(text) = self.next_line()? else {
            return Ok(None);
        };
        let (line, separator) = (self.line, self.separator);
        let cells = split_cells(&text, separator, line).and_then(|cells| {
            if cells.len() == self.columns.len() {
                return Ok(cells);
            }
            let (found, columns) = (cells.len(), self.columns.len());
            let what = format!("{found} fields, where the first line has {columns}");
            Err(FileError::new(line, "row", what))
        });
        Ok(Some(cells.map(|cells| CsvRow {
            line,
            columns: &self.columns,
            cells,
            separator,
        })))
    }

    /// Returns the next line that is not blank.
    fn next_line(&mut self) -> Result<Option<String>, FileError> {
        loop {
            let Some(text) = read_line(&mut self.file, self.line + 1)? else {
                return Ok(None);
            };
            self.line += 1;
            if !text.trim().is_empty() {
                return Ok(Some(text));
            }
        }
    }
}

impl CsvRow<'_> {
    /// Returns the text of a column; none where it is empty, or the file does not have the column.
    pub fn cell(&self, column: &str) -> Option<&str> {
        let at = self.columns.iter().position(|known| known == column)?;
        Some(unescape_formula(&self.cells[at])).filter(|text| !text.is_empty())
    }

    /// Returns the number of a column, as [`CsvRow::cell`] does. Where semicolons separate fields, a
    /// comma may be the decimal point.
    ///
    /// # Errors
    /// [`FileError`] where it is no number.
    pub fn number(&self, column: &str) -> Result<Option<f64>, FileError> {
        let Some(text) = self.cell(column) else {
            return Ok(None);
        };
        let read = match self.separator {
            ';' => text.replace(',', ".").parse::<f64>(),
            _ => text.parse::<f64>(),
        };
        match read {
            Ok(number) if number.is_finite() => Ok(Some(number)),
            _ => {
                let what = format!("{text:?} is not a number");
                Err(FileError::new(self.line, column, what))
            }
        }
    }
}

fn check_columns(
    columns: &[String],
    line: usize,
    known: &[&str],
    needed: &[&str],
) -> Result<(), FileError> {
    for (at, name) in columns.iter().enumerate() {
        if !known.contains(&name.as_str()) {
            let what = format!("is not a column; known columns are {}", known.join(", "));
            return Err(FileError::new(line, name, what));
        }
        if columns[..at].contains(name) {
            return Err(FileError::new(line, name, "appears twice"));
        }
    }
    for needed in needed {
        if !columns.iter().any(|name| name == needed) {
            return Err(FileError::new(line, needed, "the column is missing"));
        }
    }
    Ok(())
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
