//! An HTTP listener that holds out alone on the internet: it serves a router on TCP, or on what a
//! handshake such as TLS makes of it.
//!
//! Invariant: a connection waits at any time either for the server or for its peer, and it waits
//! for its peer only as long as [`Limits`] allow. That covers a handshake that never comes, half a
//! request head, a body that trickles in, a reader that takes nothing, by the system's buffers
//! or by the windows of HTTP/2 (RFC 9113, section 5.2), and a connection without a request. A
//! stream of events may last: its next event is the server's business.

mod limits;
mod open_files;
mod serve;

mod admission;
mod connection;

mod body;
mod stream;
mod turns;

pub use limits::Limits;
pub use open_files::raise_open_file_limit;
pub use serve::{plain, serve};
pub use stream::Stream;
