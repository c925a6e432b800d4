//! Import of batches that arrived as short-burst messages, through any gateway.
//!
//! Invariants:
//!
//! - They are stored like batches over an ordinary link, each frame in its own transaction.
//!   Repeated messages, or the same batch over both links, change nothing.
//! - An unreadable message does not hold back any other.

use super::{Received, store_batch};
use crate::agent_auth::Agent;
use binnacle_platform::db::{Db, row};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::events::Event;
use binnacle_platform::ids::VesselId;
use binnacle_platform::time::Time;
use binnacle_wire::burst::{Ack, Joiner, StreamTag, write_ack};
use serde::Serialize;
use std::collections::BTreeSet;
use uuid::Uuid;

/// Result of an import of messages.
#[derive(Debug, Default, Serialize)]
pub struct ImportResult {
    /// Batches that were not there before.
    pub stored: usize,
    /// Batches that were there already.
    pub repeated: usize,
    /// Batches of which messages are missing.
    pub incomplete: Vec<IncompleteBatch>,
    /// Messages, and the batches that they completed, that were not received.
    pub refused: Vec<RefusedMessage>,
    /// Events to be announced.
    #[serde(skip)]
    pub events: Vec<Event>,
    /// Acknowledgements for the ship, by stream.
    #[serde(skip)]
    pub acknowledgements: Vec<Acknowledgement>,
}

/// Message that arrived from a ship.
#[derive(Clone, Debug)]
pub struct ShortBurst {
    /// The caller's name for the message.
    pub name: String,
    /// Bytes of the message.
    pub bytes: Vec<u8>,
}

/// Message to a ship that acknowledges the batches of a stream.
#[derive(Clone, Debug)]
pub struct Acknowledgement {
    /// The stream.
    pub stream: Uuid,
    /// Bytes of the message.
    pub bytes: Vec<u8>,
}

/// A batch of which messages are missing.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct IncompleteBatch {
    /// Its number in its stream.
    pub seq: u64,
    /// Number of its messages that are stored.
    pub messages: usize,
    /// Number of its messages.
    pub of: usize,
}

/// Reason for which a message, or the batch that it completed, was refused.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct RefusedMessage {
    /// The caller's name for the message.
    pub message: String,
    /// The reason, in one line.
    pub problem: String,
}

/// Joins a vessel's messages, by name, and stores the batches.
///
/// # Errors
/// Fails when the database does; batches stored by then stay.
pub async fn import_messages(
    db: &Db,
    vessel: VesselId,
    messages: &[ShortBurst],
    now: Time,
) -> Result<ImportResult> {
    let mut imported = ImportResult::default();
    let mut joiner = Joiner::default();
    let mut streams = BTreeSet::new();
    for ShortBurst { name, bytes } in messages {
        let refuse = |problem: String| RefusedMessage {
            message: name.clone(),
            problem,
        };
        let frame = match joiner.push(bytes) {
            Ok(Some(frame)) => frame,
            Ok(None) => continue,
            Err(error) => {
                imported.refused.push(refuse(error.to_string()));
                continue;
            }
        };
        match store(db, vessel, &frame, now).await {
            Ok((stream, received)) => {
                streams.insert(stream);
                imported.stored += usize::from(received.is_new);
                imported.repeated += usize::from(!received.is_new);
                imported.events.extend(received.events_out);
            }
            Err(error @ Error::Internal(_)) => return Err(error),
            Err(error) => imported.refused.push(refuse(error.to_string())),
        }
    }
    imported.incomplete = joiner
        .incomplete()
        .map(|(_, seq, messages, of)| IncompleteBatch { seq, messages, of })
        .collect();
    for stream in streams {
        let bytes = acknowledgement(db, vessel, stream).await?;
        let acknowledgement = Acknowledgement { stream, bytes };
        imported.acknowledgements.push(acknowledgement);
    }
    Ok(imported)
}

async fn store(db: &Db, vessel: VesselId, frame: &[u8], now: Time) -> Result<(Uuid, Received)> {
    let stated =
        binnacle_wire::decode(frame).map_err(|error| Error::BadRequest(error.to_string()))?;
    // The same bounds as for a batch that came by its path.
    let batch = super::decode_batch(frame, stated.stream, stated.seq)?;
    let mut tx = db.begin().await?;
    let agent = row!(
        in &mut tx,
        Agent,
        "SELECT vessel_id, agent_id, compass_id FROM streams
         WHERE vessel_id = $1 AND id = $2 ORDER BY id",
        vessel,
        batch.stream.0
    )?
    .ok_or(Error::NotFound("stream of this vessel"))?;
    let received = store_batch(&mut tx, agent, &batch, frame, now, 0.0).await?;
    tx.commit().await?;
    Ok((batch.stream.0, received))
}

async fn acknowledgement(db: &Db, vessel: VesselId, stream: Uuid) -> Result<Vec<u8>> {
    let (contiguous_seq,) = row!(
        db,
        (i64,),
        "SELECT contiguous_seq FROM streams WHERE vessel_id = $1 AND id = $2 ORDER BY id",
        vessel,
        stream
    )?
    .ok_or(Error::NotFound("stream"))?;
    Ok(write_ack(Ack {
        stream: StreamTag::from_stream(binnacle_wire::batch::StreamId(stream)),
        contiguous_seq: contiguous_seq.unsigned_abs(),
    }))
}
