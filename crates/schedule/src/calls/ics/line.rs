//! The lines of a calendar: unfolded, with name, parameters and value.

use crate::calls::FileError;

/// Maximum length of an unfolded line, bytes.
const MAX_LINE_BYTES: usize = 16_384;

/// A content line.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Line {
    pub(super) number: usize,
    /// The name in capitals.
    pub(super) name: String,
    parameters: Vec<(String, String)>,
    /// The value without the escapes of text.
    pub(super) value: String,
}

impl Line {
    pub(super) fn is(&self, name: &str, value: &str) -> bool {
        self.name == name && self.value.eq_ignore_ascii_case(value)
    }

    pub(super) fn parameter(&self, name: &str) -> Option<&str> {
        let found = self.parameters.iter().find(|(own, _)| own == name)?;
        Some(&found.1)
    }
}

/// Splits a text into lines. A line that begins with a blank continues the line
/// before (RFC 5545, 3.1).
pub(super) fn lines(text: &str) -> Result<Vec<Line>, FileError> {
    let mut unfolded: Vec<(usize, String)> = Vec::new();
    for (at, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        match (line.strip_prefix([' ', '\t']), unfolded.last_mut()) {
            (Some(more), Some((_, previous))) => previous.push_str(more),
            _ => unfolded.push((at + 1, line.to_owned())),
        }
        if unfolded
            .last()
            .is_some_and(|(_, line)| line.len() > MAX_LINE_BYTES)
        {
            return Err(FileError::new(
                at + 1,
                "line",
                format!("is longer than {MAX_LINE_BYTES} bytes"),
            ));
        }
    }
    unfolded.retain(|(_, line)| !line.trim().is_empty());
    unfolded
        .into_iter()
        .map(|(number, line)| parse_line(number, &line))
        .collect()
}

fn parse_line(number: usize, line: &str) -> Result<Line, FileError> {
    let Some(colon) = positions_outside_quotes(line, ':').next() else {
        let what = format!(
            "{:?} is not a calendar line",
            line.chars().take(40).collect::<String>()
        );
        return Err(FileError::new(number, "line", what));
    };
    let (head, value) = (&line[..colon], &line[colon + 1..]);
    let mut begins = 0;
    let mut parts = Vec::new();
    for ends in positions_outside_quotes(head, ';').chain([head.len()]) {
        parts.push(&head[begins..ends]);
        begins = ends + 1;
    }
    let parameters = parts[1..].iter().filter_map(|part| {
        let (name, value) = part.split_once('=')?;
        Some((
            name.to_ascii_uppercase(),
            value.trim_matches('"').to_owned(),
        ))
    });
    Ok(Line {
        number,
        name: parts[0].trim().to_ascii_uppercase(),
        parameters: parameters.collect(),
        value: unescape(value.trim()),
    })
}

fn positions_outside_quotes(text: &str, separator: char) -> impl Iterator<Item = usize> {
    let mut quoted = false;
    text.char_indices().filter_map(move |(at, letter)| {
        quoted ^= letter == '"';
        (letter == separator && !quoted).then_some(at)
    })
}

fn unescape(value: &str) -> String {
    let mut text = String::with_capacity(value.len());
    let mut letters = value.chars();
    while let Some(letter) = letters.next() {
        match letter {
            '\\' => match letters.next() {
                Some('n' | 'N') => text.push('\n'),
                Some(other) => text.push(other),
                None => {}
            },
            _ => text.push(letter),
        }
    }
    text
}
