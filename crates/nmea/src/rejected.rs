//! Reasons for refusing a line. Every refusal has one reason, and reasons are
//! counted.

use crate::sentence::Kind;

/// The reason for refusing a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Rejected {
    /// It starts with none of `$`, `!` and `\`.
    #[error("not a sentence")]
    NotASentence,
    /// It holds a byte that is not printable ASCII.
    #[error("not ascii")]
    NotAscii,
    /// It is longer than [`crate::MAX_SENTENCE_BYTES`] allows.
    #[error("too long")]
    TooLong,
    /// It does not end in `*` and two digits.
    #[error("no checksum")]
    NoChecksum,
    /// Its checksum does not match its bytes.
    #[error("wrong checksum")]
    WrongChecksum,
    /// Its TAG block is cut short, has no right checksum or holds a bad value.
    #[error("bad tag block")]
    BadTagBlock,
    /// A datagram whose header is not that of sentences (`UdPbC`).
    #[error("not a datagram of sentences")]
    BadDatagram,
    /// A whole sentence that this crate does not read.
    #[error("unknown sentence")]
    UnknownSentence,
    /// A field holds a value that its sentence does not allow.
    #[error("{} with bad {field}", kind.name())]
    BadField {
        /// The sentence.
        kind: Kind,
        /// The field's name.
        field: &'static str,
    },
}

impl Rejected {
    /// The text of each reason, in the order of [`Rejected::index`].
    pub const REASONS: [&'static str; 9] = [
        "not a sentence",
        "not ascii",
        "too long",
        "no checksum",
        "wrong checksum",
        "bad tag block",
        "not a datagram of sentences",
        "unknown sentence",
        "bad field",
    ];

    /// The reason's index in [`Rejected::REASONS`].
    pub fn index(self) -> usize {
        match self {
            Rejected::NotASentence => 0,
            Rejected::NotAscii => 1,
            Rejected::TooLong => 2,
            Rejected::NoChecksum => 3,
            Rejected::WrongChecksum => 4,
            Rejected::BadTagBlock => 5,
            Rejected::BadDatagram => 6,
            Rejected::UnknownSentence => 7,
            Rejected::BadField { .. } => 8,
        }
    }

    /// The reason as text, one for all bad fields.
    pub fn reason(self) -> &'static str {
        Rejected::REASONS[self.index()]
    }
}
