//! Lines that were not understood: counted by reason, with the first of each as an example.

use binnacle_nmea::Rejected;
use serde::Serialize;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Bytes of an example that are shown.
const EXAMPLE_BYTES: usize = 80;

/// Lines of one recording that were not understood, by reason.
#[derive(Clone, Debug, Default)]
pub struct NotUnderstood(BTreeMap<&'static str, Rejections>);

/// Lines that were not understood for one reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Rejections {
    /// Number of times.
    pub count: u64,
    /// Number of the first line.
    pub line: u64,
    /// First line, as far as it is shown.
    pub example: String,
}

impl NotUnderstood {
    pub(super) fn add(&mut self, reason: &'static str, line: u64, content: &[u8]) {
        match self.0.entry(reason) {
            Entry::Occupied(mut entry) => entry.get_mut().count += 1,
            Entry::Vacant(entry) => {
                entry.insert(Rejections {
                    count: 1,
                    line,
                    example: example(content),
                });
            }
        }
    }

    /// Iterates over the reasons.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &Rejections)> {
        self.0
            .iter()
            .map(|(reason, rejections)| (*reason, rejections))
    }

    /// Returns whether a reason is that of a whole sentence or value which the agent does not use.
    pub fn is_of_no_use(reason: &str) -> bool {
        reason == Rejected::UnknownSentence.reason()
            || matches!(
                reason,
                "unknown path" | "another vessel" | "computed by the server"
            )
    }
}

fn example(content: &[u8]) -> String {
    let shown = &content[..content.len().min(EXAMPLE_BYTES)];
    let dots = if shown.len() < content.len() {
        "…"
    } else {
        ""
    };
    // Printable text as it is, everything else escaped.
    let text = match std::str::from_utf8(shown) {
        Ok(text) if !text.chars().any(char::is_control) => text.to_owned(),
        _ => shown.escape_ascii().to_string(),
    };
    text + dots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_line_of_each_reason_is_kept_and_all_are_counted() {
        let mut lines = NotUnderstood::default();
        lines.add("no checksum", 7, b"$GPZDA,1");
        lines.add("no checksum", 8, b"$GPZDA,2");
        lines.add("not a sentence", 9, b"\x00\xff");
        let all: Vec<_> = lines.iter().collect();
        assert_eq!(
            (all[0].0, all[0].1.count, all[0].1.line),
            ("no checksum", 2, 7)
        );
        assert_eq!(all[0].1.example, "$GPZDA,1");
        assert_eq!(all[1].1.example, "\\x00\\xff");
    }

    #[test]
    fn a_long_example_is_cut() {
        let mut lines = NotUnderstood::default();
        lines.add("too long", 1, &[b'x'; 500]);
        let (_, rejections) = lines.iter().next().unwrap();
        assert_eq!(rejections.example.chars().count(), EXAMPLE_BYTES + 1);
    }
}
