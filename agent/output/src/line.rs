//! Sentences to be sent, with their kind: a destination may take some of them only.

use crate::config::{Selection, SentenceKind};

/// A sentence with its line end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Kind.
    pub kind: SentenceKind,
    /// Sentence.
    pub text: Vec<u8>,
}

impl Line {
    /// Splits sentences of one kind.
    pub fn split(kind: SentenceKind, sentences: &[u8]) -> impl Iterator<Item = Line> {
        sentences
            .split_inclusive(|byte| *byte == b'\n')
            .map(move |text| Line {
                kind,
                text: text.to_vec(),
            })
    }

    /// Returns whether a newer line of the same kind replaces this one.
    pub(crate) fn is_heading(&self) -> bool {
        !matches!(self.kind, SentenceKind::Alr | SentenceKind::Alf)
    }
}

/// Returns the lines that a destination takes.
pub(crate) fn select<'a>(
    lines: &'a [Line],
    selection: &'a Selection,
) -> impl Iterator<Item = &'a Line> {
    lines.iter().filter(|line| selection.includes(line.kind))
}
