//! Archive of the evidence.

use crate::work_orders::log::canonical_json::{canonical, sha256_hex};
use crate::work_orders::log::seal::SealedEntry;
use anyhow::Context;
use binnacle_platform::signing_keys::{Seal, ServerKey};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// File of the archive.
#[derive(Clone, Debug)]
pub(crate) struct File {
    /// Name in the archive.
    pub(crate) name: String,
    /// Content.
    pub(crate) bytes: Vec<u8>,
}

/// Line of a log.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    /// Text of the line, or the substitute of one that is withheld.
    pub(crate) text: String,
    /// Original line as the server signed it.
    pub(crate) sealed: SealedEntry,
}

/// Content of an archive.
#[derive(Clone, Debug)]
pub(crate) struct Evidence {
    /// Id of the order.
    pub(crate) order: String,
    /// Reader for whom it is made: `operator`, or the id of a firm.
    pub(crate) reader: String,
    /// Lines of the log.
    pub(crate) lines: Vec<Line>,
    /// All files but readme, log, seals and manifest.
    pub(crate) files: Vec<File>,
}

/// Content of `manifest.json`. Version 1 has neither reader, maker nor seal.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Manifest {
    pub(super) version: u32,
    pub(super) order: String,
    /// Reader for whom the archive was made: `operator`, or the id of a firm.
    #[serde(default)]
    pub(super) reader: Option<String>,
    /// Version of the program that made the archive.
    #[serde(default)]
    pub(super) made_by: Option<String>,
    /// SHA-256 by name.
    pub(super) files: BTreeMap<String, String>,
    pub(super) log: LogHead,
    /// The server's signature over all else.
    #[serde(default)]
    pub(super) seal: Option<Seal>,
}

impl Manifest {
    /// Returns the text that the server signs: canonical JSON without the signature.
    pub(super) fn text(&self) -> anyhow::Result<String> {
        let mut unsigned = serde_json::to_value(self)?;
        unsigned["seal"] = "evidence of a work order".into();
        Ok(canonical(&unsigned)?)
    }
}

/// Length of the log, with the hash of its last entry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct LogHead {
    pub(super) entries: i64,
    pub(super) last_sha256: String,
}

/// Writes the archive, signed by the server.
///
/// # Errors
/// Fails when memory is exhausted.
pub(crate) fn archive(evidence: Evidence, key: &ServerKey) -> anyhow::Result<Vec<u8>> {
    let texts: Vec<&str> = evidence
        .lines
        .iter()
        .map(|line| line.text.as_str())
        .collect();
    let mut log = texts.join("\n");
    log.push('\n');
    let last = evidence.lines.last().context("an order without a log")?;
    let head = LogHead {
        entries: evidence.lines.len() as i64,
        last_sha256: last.sealed.sha256.clone(),
    };
    let seals: Result<Vec<String>, _> = evidence
        .lines
        .iter()
        .map(|line| canonical(&line.sealed))
        .collect();
    let mut seals = seals?.join("\n");
    seals.push('\n');
    let mut files = evidence.files;
    let file = |name: &str, text: &str| File {
        name: name.to_owned(),
        bytes: text.as_bytes().to_vec(),
    };
    files.push(file("README.txt", super::README));
    files.push(file("entries.ndjson", &log));
    files.push(file("seals.ndjson", &seals));
    files.sort_by(|a, b| a.name.cmp(&b.name));
    let mut manifest = Manifest {
        version: 2,
        order: evidence.order,
        reader: Some(evidence.reader),
        made_by: Some(env!("CARGO_PKG_VERSION").to_owned()),
        files: files
            .iter()
            .map(|file| (file.name.clone(), sha256_hex(&file.bytes)))
            .collect(),
        log: head,
        seal: None,
    };
    manifest.seal = Some(key.sign(manifest.text()?.as_bytes()));
    files.push(file(
        "manifest.json",
        &serde_json::to_string_pretty(&manifest)?,
    ));
    write(&files)
}

/// Packs files in this order; the same files give the same bytes.
fn write(files: &[File]) -> anyhow::Result<Vec<u8>> {
    // Photographs are compressed already; the rest is small. Files carry no time of their own.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for file in files {
        writer.start_file(file.name.as_str(), options)?;
        writer.write_all(&file.bytes)?;
    }
    Ok(writer.finish()?.into_inner())
}
