//! Batches over a modem that carries messages of a few hundred octets, for ships
//! without any other link at sea.
//!
//! What always holds:
//!
//! - A batch that went out as messages stays in the spool until the shore has
//!   acknowledged it, over the modem or over an ordinary link: a message that is lost
//!   costs nothing but time.
//! - Its octets are those that an ordinary link sends, so that the shore may get it
//!   both ways, in any order, and has it once.
//! - How many of its messages are out is kept after each: a restart repeats one at most.
//! - An answer deletes only what is out.

mod file;

pub(crate) use file::FileModem;

use crate::spool::Spool;
use binnacle_wire::burst::{StreamTag, read_ack, split};
use std::io;
use std::time::Duration;
use tokio_util::sync::CancellationToken;

/// How often the spool and the modem are looked at.
const POLL_INTERVAL: Duration = Duration::from_secs(5);
/// After a modem that did not take a message.
const RETRY_PAUSE: Duration = Duration::from_mins(2);
/// What takes messages to the shore and back.
pub(crate) trait Modem: Send {
    /// Hands one message over; it is on its way when this succeeds.
    fn send(&mut self, message: &[u8]) -> impl Future<Output = io::Result<()>> + Send;
    /// The next message from the shore, if there is one. It does not come again.
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

/// Everything that there is to do; how long to wait then.
async fn step(spool: &Spool, modem: &mut impl Modem) -> Duration {
    match exchange(spool, modem).await {
        Ok(()) => POLL_INTERVAL,
        Err(error) => {
            tracing::warn!(error = format!("{error:#}"), "the modem's turn failed");
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
            Ok(ack) if ack.stream == StreamTag::of(identity.stream) => {
                let acknowledged = spool
                    .acknowledge_bursts(&identity, ack.contiguous_seq)
                    .await?;
                tracing::info!(seq = ack.contiguous_seq, acknowledged, "the shore answered");
            }
            Ok(_) => tracing::warn!("an answer to another stream was passed over"),
            Err(error) => tracing::warn!(%error, "a message was passed over"),
        }
    }
    while let Some((batch, sent)) = spool.next_burst_batch().await? {
        let messages = match split(&batch.bytes) {
            Ok(messages) => messages,
            Err(error) => {
                tracing::error!(seq = batch.seq, %error, "a batch waits for another link");
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
        tracing::info!(seq = batch.seq, messages = messages.len(), "a batch is out");
    }
    Ok(())
}

#[cfg(test)]
mod tests;
