//! Errors of encoding a batch and decoding a frame.

/// The reason why a batch cannot be written as a frame.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EncodeError {
    /// More samples than a frame may hold.
    #[error("{0} samples exceed the limit of 65535 per batch")]
    TooManySamples(usize),
    /// The frame would be larger than the server accepts.
    #[error("the batch has {0} bytes, more than the limit of 262144")]
    TooLarge(usize),
    /// Batches are numbered from 1.
    #[error("batch number 0: numbers start at 1")]
    SeqZero,
    /// A value that no vessel can have, or NaN.
    #[error("sample {row}: {field} {value} is outside {low} to {high}")]
    OutOfRange {
        /// Index in the batch's samples, from 0.
        row: usize,
        /// Name of the field in JSON.
        field: &'static str,
        /// The value given.
        value: f64,
        /// The least value that is accepted.
        low: f64,
        /// The greatest value that is accepted.
        high: f64,
    },
    /// More reasons than a tally may have.
    #[error("{0} reasons exceed the limit of 255 per tally")]
    TooManyReasons(usize),
    /// More alerts than a frame may hold.
    #[error("{0} alerts exceed the limit of 254 per batch")]
    TooManyAlerts(usize),
    /// A value that no alert can have.
    #[error("an alert's {0} is out of range")]
    Alert(&'static str),
    /// A reason's name is empty or longer than 64 bytes.
    #[error("reason {0:?} is not 1 to 64 bytes long")]
    ReasonName(String),
}

/// The reason why bytes are not a batch.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DecodeError {
    /// The bytes end before the frame does.
    #[error("the frame is cut short")]
    Truncated,
    /// More bytes than a frame may have.
    #[error("{0} bytes exceed the limit of 262144 per batch")]
    TooLarge(usize),
    /// The bytes are something else altogether.
    #[error("these bytes are not a batch: they do not begin with 42 4e")]
    BadMagic,
    /// The bytes were damaged on the way or on disk.
    #[error("the checksum is {computed:08x}, but the frame states {stated:08x}")]
    Checksum {
        /// The frame's last four bytes.
        stated: u32,
        /// The checksum of the other bytes.
        computed: u32,
    },
    /// Written by a later agent. Keep the batch until the server is newer.
    #[error("unsupported batch version {0}")]
    UnsupportedVersion(u8),
    /// A flag of a later version.
    #[error("unsupported batch flags {0:#04x}")]
    UnsupportedFlags(u8),
    /// Batches are numbered from 1.
    #[error("batch number 0: numbers start at 1")]
    SeqZero,
    /// More samples than a frame may hold, or than its bytes can.
    #[error("{0} samples do not fit into this frame")]
    TooManySamples(u64),
    /// A number of more than 64 bits.
    #[error("a number has more than 64 bits")]
    NumberTooLong,
    /// Column ids must rise, and at most 64 are allowed.
    #[error("column {0} is out of order or exceeds the limit of 64")]
    ColumnOrder(u64),
    /// A required column is missing or has gaps.
    #[error("column {0} is missing or has gaps")]
    MissingColumn(u64),
    /// A step of zero, or one that does not divide the circle.
    #[error("column {0} has no usable step")]
    BadStep(u64),
    /// The column of times cannot be predicted from times.
    #[error("column {0} has an invalid predictor")]
    BadPredictor(u64),
    /// A run that is longer than the rest of the column.
    #[error("column {0} has a run beyond its end")]
    BadRun(u64),
    /// A value that no vessel can have.
    #[error("sample {row}: column {column} is out of range")]
    OutOfRange {
        /// Index in the batch's samples, from 0.
        row: usize,
        /// The column's id.
        column: u64,
    },
    /// The samples are not in order of time.
    #[error("sample {0} is earlier than the one before it")]
    OutOfOrder(usize),
    /// A reason that is unknown, unreadable, empty, too long or repeated.
    #[error("entry {0} of the tally cannot be read")]
    BadReason(usize),
    /// More notes than a frame may hold.
    #[error("{0} notes exceed the limit of 255 per batch")]
    TooManyNotes(u64),
    /// A note of a known kind that is cut short, out of range or repeated.
    #[error("a note of kind {0} cannot be read")]
    BadNote(u64),
    /// Bits follow the last column.
    #[error("unexpected data after the last column")]
    TrailingBits,
}
