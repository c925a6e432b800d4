//! Lines of a file with their numbers, however it is cut into chunks.
//!
//! Memory is bounded: a longer line is dropped and reported as such. Line ends are LF, CR LF or,
//! in files without LF, CR. Empty lines are counted and not reported.

use binnacle_nmea::lines::Line;

/// Longest line: a Signal K delta with the metadata of every path.
const MAX_LINE_BYTES: usize = 1024 * 1024;

#[derive(Debug, Default)]
pub(super) struct NumberedLines {
    unfinished: Vec<u8>,
    skipping: bool,
    line_feeds: u64,
    carriage_returns: u64,
}

impl NumberedLines {
    /// Passes each line that a chunk completes to `each`, with its number from 1.
    pub(super) fn push(&mut self, chunk: &[u8], mut each: impl FnMut(u64, Line<'_>)) {
        let mut rest = chunk;
        while let Some(end) = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')) {
            self.complete(&rest[..end], &mut each);
            if rest[end] == b'\n' {
                self.line_feeds += 1;
            } else {
                self.carriage_returns += 1;
            }
            rest = &rest[end + 1..];
        }
        if self.skipping {
            return;
        }
        if self.unfinished.len() + rest.len() > MAX_LINE_BYTES {
            self.unfinished = Vec::new();
            self.skipping = true;
            each(self.number(), Line::TooLong);
            return;
        }
        self.unfinished.extend_from_slice(rest);
    }

    /// Completes the last line, whose end may be missing.
    pub(super) fn finish(&mut self, mut each: impl FnMut(u64, Line<'_>)) {
        self.complete(b"", &mut each);
    }

    fn number(&self) -> u64 {
        if self.line_feeds > 0 {
            self.line_feeds + 1
        } else {
            self.carriage_returns + 1
        }
    }

    fn complete(&mut self, tail: &[u8], each: &mut impl FnMut(u64, Line<'_>)) {
        if std::mem::take(&mut self.skipping) {
            return;
        }
        let number = self.number();
        if self.unfinished.is_empty() {
            if !tail.is_empty() {
                each(number, Line::Whole(tail));
            }
            return;
        }
        self.unfinished.extend_from_slice(tail);
        each(number, Line::Whole(&self.unfinished));
        self.unfinished.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbered(text: &[u8], chunk: usize) -> Vec<(u64, String)> {
        let mut lines = NumberedLines::default();
        let mut out = Vec::new();
        let mut keep = |number, line: Line<'_>| {
            out.push(match line {
                Line::Whole(line) => (number, String::from_utf8_lossy(line).into_owned()),
                Line::TooLong => (number, "too long".to_owned()),
            });
        };
        for chunk in text.chunks(chunk) {
            lines.push(chunk, &mut keep);
        }
        lines.finish(&mut keep);
        out
    }

    #[test]
    fn numbers_are_those_of_an_editor_whatever_the_line_ends() {
        for text in [
            "a\nb\n\nc",
            "a\r\nb\r\n\r\nc\r\n",
            "a\rb\r\rc\r",
            "a\r\r\nb\r\r\n\r\nc",
        ] {
            for chunk in 1..=text.len() {
                let expected = [(1, "a"), (2, "b"), (4, "c")];
                let expected = expected.map(|(number, line)| (number, line.to_owned()));
                assert_eq!(
                    numbered(text.as_bytes(), chunk),
                    expected,
                    "{text:?} {chunk}"
                );
            }
        }
    }

    #[test]
    fn an_endless_line_is_reported_once() {
        let mut text = b"a\n".to_vec();
        text.resize(3 * MAX_LINE_BYTES, b'x');
        text.extend_from_slice(b"\nb");
        let expected = [(1, "a"), (2, "too long"), (3, "b")];
        let expected = expected.map(|(number, line)| (number, line.to_owned()));
        assert_eq!(numbered(&text, 4096), expected);
    }
}
