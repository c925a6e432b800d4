//! Error of an output that cannot be opened.

use std::io;
use std::net::SocketAddr;

/// Output that cannot be opened.
#[derive(Debug, thiserror::Error)]
#[error("output.{field} {address} cannot be opened")]
pub struct OpenError {
    pub(crate) field: &'static str,
    pub(crate) address: SocketAddr,
    pub(crate) source: io::Error,
}
