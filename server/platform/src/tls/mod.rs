//! TLS on the server's own listener, for a server without a proxy in front of it.
//!
//! Invariants: a slow handshake delays no other connection. A certificate that cannot be
//! read is refused at the start; on a reload it leaves the previous one in use.

mod certificate;
mod connection;

mod listener;

pub use certificate::Certificate;
pub use connection::TlsConnection;
pub use listener::TlsListener;
