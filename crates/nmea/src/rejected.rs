//! Why a line is not used. Every refusal has one reason, and reasons are counted.

use crate::sentence::Kind;

/// Why a line was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Rejected {
    /// It starts with none of `$`, `!` and `\`.
    #[error("not a sentence")]
    NotASentence,
    /// It holds a byte that is not printable ASCII.
    #[error("not ascii")]
    NotAscii,
    /// It is longer than any honest sentence.
    #[error("too long")]
    TooLong,
    /// It does not end in `*` and two digits.
    #[error("no checksum")]
    NoChecksum,
    /// Its checksum is not the one its bytes have.
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
    /// A field holds what it must not.
    #[error("{} with bad {field}", kind.name())]
    BadField {
        /// The sentence.
        kind: Kind,
        /// The field's name.
        field: &'static str,
    },
}

impl Rejected {
    /// The words for each reason, in the order of [`Rejected::index`].
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

    /// Where the reason stands in [`Rejected::REASONS`].
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

    /// The reason in words, one for all bad fields.
    pub fn reason(self) -> &'static str {
        Rejected::REASONS[self.index()]
    }
}
