//! Batches over a modem that carries messages of a few hundred bytes, for vessels without any other
//! link at sea.
//!
//! Invariants:
//!
//! - A batch that was sent as messages stays in the spool until the server has acknowledged it,
//!   over the modem or over an ordinary link. A lost message costs only time.
//! - Its bytes are those that an ordinary link sends. The server may receive it both ways, in any
//!   order, and stores it once.
//! - The number of sent messages is stored after each of them: a restart repeats at most one.
//! - An acknowledgement deletes only what was sent; one beyond that is refused.

mod file;

pub(crate) use file::FileModem;

use crate::spool::Spool;
use binnacle_wire::burst::{StreamTag, read_ack, split};
use std::io;
use std::time::Duration;
use tokio_util::sync::CancellationToken;

/// Interval at which spool and modem are polled.
const POLL_INTERVAL: Duration = Duration::from_secs(5);
/// Pause after the modem failed to take a message.
const RETRY_PAUSE: Duration = Duration::from_mins(2);
/// Carrier of messages to the server and back.
pub(crate) trait Modem: Send {
    /// Sends one message, which is on its way when this succeeds.
    fn send(&mut self, message: &[u8]) -> impl Future<Output = io::Result<()>> + Send;
    /// Receives the next message of the server, if there is one; each is received once.
    fn receive(&mut self) -> impl Future<Output = io::Result<Option<Vec<u8>>>> + Send;
}

/// Runs until `shutdown`.
pub(crate) async fn run(spool: Spool, mut modem: impl Modem, shutdown: CancellationToken) {
    loop {
        let pause = step(&spool, &mut modem).await;
        let rest = tokio::time::sleep(pause);
        if shutdown.run_until_cancelled(rest).await.is_none() {
            return;
        }
    }
}

/// Sends and receives everything there is. Returns the pause before the next step.
async fn step(spool: &Spool, modem: &mut impl Modem) -> Duration {
    match exchange(spool, modem).await {
        Ok(()) => POLL_INTERVAL,
        Err(error) => {
            tracing::warn!(
                error = format!("{error:#}"),
                "the exchange with the modem failed"
            );
            RETRY_PAUSE
        }
    }
}

async fn exchange(spool: &Spool, modem: &mut impl Modem) -> anyhow::Result<()> {
    let Some(identity) = spool.identity().await? else {
        return Ok(());
    };
    while let Some(message) = modem.receive().await? {
        match read_ack(&message) {
            Ok(ack) if ack.stream == StreamTag::from_stream(identity.stream) => {
                let seq = ack.contiguous_seq;
                match spool.acknowledge_bursts(&identity, seq).await? {
                    Ok(acknowledged) => {
                        tracing::info!(seq, acknowledged, "the server acknowledged batches");
                    }
                    Err(refused) => tracing::error!("an acknowledgement was refused: {refused}"),
                }
            }
            Ok(_) => tracing::warn!("an acknowledgement of another stream was ignored"),
            Err(error) => tracing::warn!(%error, "an invalid message was ignored"),
        }
    }
    while let Some((batch, sent)) = spool.next_burst_batch().await? {
        let messages = match split(&batch.bytes) {
            Ok(messages) => messages,
            Err(error) => {
                tracing::error!(seq = batch.seq, %error, "a batch is too large for short messages");
                spool.exclude_from_bursts(&batch).await?;
                continue;
            }
        };
        if !spool.mark_tried(&batch).await? {
            continue;
        }
        for (index, message) in messages.iter().enumerate().skip(sent) {
            modem.send(message).await?;
            spool
                .record_burst_progress(&batch, index + 1, messages.len())
                .await?;
        }
        tracing::info!(
            seq = batch.seq,
            messages = messages.len(),
            "a batch was sent as short messages"
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests;
