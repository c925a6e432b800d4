//! `bursts`: imports batches that were sent as short-burst messages, one per file.

use crate::cli::Bursts;
use crate::command::operate::block_on;
use crate::command::{BadInput, json, print_result};
use crate::subscriptions::subscribers;
use anyhow::{Context, Result};
use binnacle_fleet::ingest::{self, ShortBurst};
use binnacle_platform::clock::Clock;
use binnacle_platform::events;
use binnacle_platform::ids::VesselId;
use binnacle_wire::burst::MESSAGE_BYTES;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::ExitCode;

/// Stores the batches and prints the outcome as JSON. The exit code is 2 when some messages
/// were refused; the others are stored nevertheless.
///
/// # Errors
/// Fails when the database cannot be reached, or a response cannot be written.
pub fn bursts(arguments: &Bursts) -> Result<ExitCode> {
    let mut messages = Vec::new();
    for path in &arguments.messages {
        let name = path.display().to_string();
        match read(path) {
            Ok(bytes) => messages.push(ShortBurst { name, bytes }),
            Err(error) => return print_result(Err(BadInput(format!("{name}: {error}")))),
        }
    }
    let vessel = VesselId(arguments.vessel);
    let imported = block_on(async {
        let db = arguments.database.open(subscribers()).await?;
        db.migrate().await?;
        let now = Clock::System.now().into();
        let imported = ingest::import_messages(&db, vessel, &messages, now).await;
        if let Ok(imported) = &imported {
            events::announce_all(&db, &imported.events).await?;
        }
        db.close().await;
        Ok(imported?)
    })?;
    if let Some(folder) = &arguments.answers {
        for acknowledgement in &imported.acknowledgements {
            let path = folder.join(format!("{}.sbd", acknowledgement.stream));
            write_whole(&path, &acknowledgement.bytes)
                .with_context(|| path.display().to_string())?;
        }
    }
    let printed = print_result(Ok(json(&imported)))?;
    for refused in &imported.refused {
        let (message, problem) = (&refused.message, &refused.problem);
        writeln!(io::stderr().lock(), "binnacle-server: {message}: {problem}")?;
    }
    Ok(if imported.refused.is_empty() {
        printed
    } else {
        ExitCode::from(2)
    })
}

/// Reads at most one byte more than a message may have, so that a longer file is detected.
fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let most = MESSAGE_BYTES as u64 + 1;
    File::open(path)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let partial = path.with_extension("partial");
    fs::write(&partial, bytes)?;
    fs::rename(partial, path)
}
