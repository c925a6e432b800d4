//! Splits a stream of bytes into lines, however it is cut into chunks.
//!
//! Memory is bounded: a line longer than [`MAX_LINE_BYTES`] is dropped, and
//! reading resumes after its end. CR, LF and both end a line; empty lines are
//! not reported.

/// The longest accepted line: a sentence, TAG blocks and a time before it.
pub const MAX_LINE_BYTES: usize = 1024;

/// One item of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line<'a> {
    /// A line without its end; not empty.
    Whole(&'a [u8]),
    /// Stands for a skipped line that was too long.
    TooLong,
}

/// Cuts chunks into lines; keeps the unfinished last line between chunks.
#[derive(Clone, Debug, Default)]
pub struct Lines {
    unfinished: Vec<u8>,
    skipping: bool,
}

impl Lines {
    /// Hands each line that `chunk` completes to `each`.
    pub fn push(&mut self, chunk: &[u8], mut each: impl FnMut(Line<'_>)) {
        let mut rest = chunk;
        while let Some(end) = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r') {
            self.complete(&rest[..end], &mut each);
            rest = &rest[end + 1..];
        }
        if self.skipping {
            return;
        }
        if self.unfinished.len() + rest.len() > MAX_LINE_BYTES {
            self.unfinished.clear();
            self.skipping = true;
            each(Line::TooLong);
            return;
        }
        self.unfinished.extend_from_slice(rest);
    }

    /// Completes the last line, at the end of a stream or datagram without a
    /// line end.
    pub fn finish(&mut self, mut each: impl FnMut(Line<'_>)) {
        self.complete(b"", &mut each);
    }

    fn complete(&mut self, tail: &[u8], each: &mut impl FnMut(Line<'_>)) {
        if self.skipping {
            self.skipping = false;
            return;
        }
        if self.unfinished.len() + tail.len() > MAX_LINE_BYTES {
            self.unfinished.clear();
            each(Line::TooLong);
        } else if self.unfinished.is_empty() {
            if !tail.is_empty() {
                each(Line::Whole(tail));
            }
        } else {
            self.unfinished.extend_from_slice(tail);
            each(Line::Whole(&self.unfinished));
            self.unfinished.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines with `!` for one that was too long.
    fn cut(stream: &[u8], chunk: usize) -> Vec<Vec<u8>> {
        let mut lines = Lines::default();
        let mut out = Vec::new();
        let mut keep = |line: Line<'_>| {
            out.push(match line {
                Line::Whole(line) => line.to_vec(),
                Line::TooLong => b"!".to_vec(),
            });
        };
        for chunk in stream.chunks(chunk) {
            lines.push(chunk, &mut keep);
            assert!(lines.unfinished.capacity() <= 2 * MAX_LINE_BYTES);
        }
        lines.finish(&mut keep);
        out
    }

    #[test]
    fn lines_are_the_same_whatever_the_chunks() {
        let stream = b"$A*00\r\n\n$B*00\n$C*00\r$D*00";
        for chunk in 1..=stream.len() {
            assert_eq!(cut(stream, chunk), [b"$A*00", b"$B*00", b"$C*00", b"$D*00"]);
        }
    }

    #[test]
    fn a_line_of_ten_megabytes_is_skipped_and_counted_once() {
        let mut stream = b"$A*00\n".to_vec();
        stream.resize(10_000_000, b'x');
        stream.extend_from_slice(b"\r\n$B*00\n");
        for chunk in [7, 4096, stream.len()] {
            assert_eq!(cut(&stream, chunk), [&b"$A*00"[..], b"!", b"$B*00"]);
        }
    }

    #[test]
    fn the_longest_line_is_kept_and_the_next_longer_is_not() {
        let mut stream = vec![b'x'; MAX_LINE_BYTES];
        stream.push(b'\n');
        stream.resize(2 * MAX_LINE_BYTES + 2, b'y');
        for chunk in [1, 1000, stream.len()] {
            let lines = cut(&stream, chunk);
            assert_eq!(lines.len(), 2);
            assert_eq!(lines[0].len(), MAX_LINE_BYTES);
            assert_eq!(lines[1], b"!");
        }
    }
}
