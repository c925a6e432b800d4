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
use binnacle_wire::burst::{StreamTag, capacity, read_ack, split};
use std::io;
use std::time::Duration;
use tokio_util::sync::CancellationToken;

/// How often the spool and the modem are looked at.
const LOOK: Duration = Duration::from_secs(5);
/// After a modem that did not take a message.
const PAUSE: Duration = Duration::from_mins(2);
/// A batch is thinned until it fits into so many messages.
pub(crate) const MESSAGES_A_BATCH: usize = 3;

/// The octets of those.
pub(crate) fn batch_octets() -> usize {
    capacity(MESSAGES_A_BATCH)
}

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
        Ok(()) => LOOK,
        Err(error) => {
            tracing::warn!(error = format!("{error:#}"), "the modem's turn failed");
            PAUSE
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
                let acknowledged = spool
                    .acknowledge_burst(&identity, ack.contiguous_seq)
                    .await?;
                tracing::info!(seq = ack.contiguous_seq, acknowledged, "the shore answered");
            }
            Ok(_) => tracing::warn!("an answer to another stream was passed over"),
            Err(error) => tracing::warn!(%error, "a message was passed over"),
        }
    }
    while let Some((batch, sent)) = spool.next_burst().await? {
        let messages = match split(&batch.bytes) {
            Ok(messages) => messages,
            Err(error) => {
                tracing::error!(seq = batch.seq, %error, "a batch waits for another link");
                spool.not_for_bursts(&batch).await?;
                continue;
            }
        };
        if !spool.note_try(&batch).await? {
            continue;
        }
        for (index, message) in messages.iter().enumerate().skip(sent) {
            modem.send(message).await?;
            spool.note_burst(&batch, index + 1, messages.len()).await?;
        }
        tracing::info!(seq = batch.seq, messages = messages.len(), "a batch is out");
    }
    Ok(())
}

#[cfg(test)]
mod tests;
