//! CAN bus of the kernel: frames are read on a thread of their own, and written without waiting.

use binnacle_nmea::n2k::{Frame, Header};
use socketcan::{CanFrame, CanSocket, EmbeddedFrame, ExtendedId, Frame as _, Socket};
use std::io;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc;

/// Longest time for which the thread waits for a frame.
const READ_TIMEOUT: Duration = Duration::from_millis(500);
/// Longest time for which a write waits for the kernel.
const WRITE_TIMEOUT: Duration = Duration::from_millis(5);
/// Frames that may wait to be decoded.
const FRAMES_AT_ONCE: usize = 64;

/// Open bus.
#[derive(Debug)]
pub(crate) struct CanBus {
    socket: Arc<CanSocket>,
    frames: mpsc::Receiver<io::Result<CanFrame>>,
}

impl CanBus {
    /// Starts to read a socket.
    pub(crate) fn start(socket: CanSocket) -> io::Result<CanBus> {
        // Between frames the thread looks whether it is still needed.
        socket.set_read_timeout(READ_TIMEOUT)?;
        socket.set_write_timeout(WRITE_TIMEOUT)?;
        let socket = Arc::new(socket);
        let reader = Arc::clone(&socket);
        let (tx, frames) = mpsc::channel(FRAMES_AT_ONCE);
        tokio::task::spawn_blocking(move || read_frames(&reader, &tx));
        Ok(CanBus { socket, frames })
    }

    /// Returns the next frame: none in its place for error frames and those of other protocols,
    /// and none at all once the bus is closed.
    pub(crate) async fn next(&mut self) -> Option<io::Result<Option<Frame>>> {
        let frame = self.frames.recv().await?;
        Some(frame.map(|frame| n2k_frame(&frame)))
    }

    /// Writes a frame.
    ///
    /// # Errors
    /// The kernel's queue is full, or the bus is down.
    pub(crate) fn write(&self, frame: &Frame) -> io::Result<()> {
        let identifier = ExtendedId::new(frame.header.identifier());
        let frame = identifier.and_then(|identifier| CanFrame::new(identifier, frame.data()));
        self.socket
            .write_frame(&frame.ok_or(io::ErrorKind::InvalidData)?)
    }
}

fn n2k_frame(frame: &CanFrame) -> Option<Frame> {
    let CanFrame::Data(data) = frame else {
        return None;
    };
    let header = Header::from_identifier(data.raw_id());
    Frame::new(header, data.data()).filter(|_| data.is_extended())
}

fn read_frames(socket: &CanSocket, tx: &mpsc::Sender<io::Result<CanFrame>>) {
    loop {
        match socket.read_frame() {
            Ok(frame) => {
                if tx.blocking_send(Ok(frame)).is_err() {
                    return;
                }
            }
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
                ) =>
            {
                if tx.is_closed() {
                    return;
                }
            }
            Err(error) => {
                // A receiver that is gone needs no reason.
                tx.blocking_send(Err(error)).ok();
                return;
            }
        }
    }
}
