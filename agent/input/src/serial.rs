//! Sentences from a serial port.

use super::link::{End, Link};
use super::pump::pump;
use crate::config::SerialConfig;
use std::io;
use tokio_serial::SerialPortBuilderExt;

pub(crate) async fn session(port: &SerialConfig, link: &Link) -> io::Result<End> {
    let stream = tokio_serial::new(&port.path, port.baud).open_native_async()?;
    link.opened();
    pump(stream, link).await
}
