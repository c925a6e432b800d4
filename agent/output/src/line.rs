//! Sentences to be sent, with their kind: a destination may take some of them only.

use crate::config::{Selection, SentenceKind};

/// A sentence with its line end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Kind.
    pub kind: SentenceKind,
    /// Sentence.
    pub text: Vec<u8>,
    /// Place in a message of several sentences.
    pub(crate) part: Option<Part>,
}

/// Place of a sentence in a message of several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Part {
    /// Number of the sentence, counted from 1.
    pub(crate) number: u8,
    /// Number of sentences in the message.
    pub(crate) total: u8,
}

impl Line {
    /// Creates a sentence that is a whole message.
    pub fn single(kind: SentenceKind, text: Vec<u8>) -> Line {
        Line {
            kind,
            text,
            part: None,
        }
    }

    /// Splits sentences of one kind, each a whole message.
    pub fn split(kind: SentenceKind, sentences: &[u8]) -> impl Iterator<Item = Line> {
        let lines = sentences.split_inclusive(|byte| *byte == b'\n');
        lines.map(move |text| Line::single(kind, text.to_vec()))
    }

    /// Splits the sentences of one message.
    pub(crate) fn of_message(kind: SentenceKind, message: &[u8]) -> Vec<Line> {
        let mut lines: Vec<Line> = Line::split(kind, message).collect();
        let total = u8::try_from(lines.len()).unwrap_or(u8::MAX);
        if total > 1 {
            for (line, number) in lines.iter_mut().zip(1..=total) {
                line.part = Some(Part { number, total });
            }
        }
        lines
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
