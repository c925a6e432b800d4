//! TLS on the server's own listener, for a server without a proxy in front of it.
//!
//! Invariants: a certificate that cannot be read is refused at the start; on a reload it leaves
//! the previous one in use.

mod acceptor;
mod certificate;
mod connection;

pub use acceptor::TlsAcceptor;
pub use certificate::Certificate;
pub use connection::TlsConnection;
