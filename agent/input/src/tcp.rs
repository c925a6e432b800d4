//! Sentences over TCP, from a multiplexer or serial server.

use super::link::{End, Link, connect};
use super::pump::pump;
use crate::config::HostPort;
use std::io;

pub(crate) async fn session(address: &HostPort, link: &Link) -> io::Result<End> {
    let stream = connect(address.as_str()).await?;
    link.opened();
    pump(stream, link).await
}
