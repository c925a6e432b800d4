//! TLS on the server's own listener, for a server without a proxy before it.
//!
//! Invariants: a handshake, however slow, keeps nobody else waiting; a
//! certificate that cannot be read is refused at the start, and later leaves the
//! one before in use.

mod certificate;
mod line;
mod listener;

pub use certificate::Certificate;
pub use line::Line;
pub use listener::TlsListener;
