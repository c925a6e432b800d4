//! Archive of the evidence.

use crate::work_orders::log::canonical_json::sha256_hex;
use anyhow::Context;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// File of the archive.
#[derive(Clone, Debug)]
pub struct File {
    /// Name in the archive.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// Line of a log.
#[derive(Clone, Debug)]
pub struct Line {
    /// Text of the line, or the substitute of one that is withheld.
    pub text: String,
    /// SHA-256 of the original line, hexadecimal.
    pub sha256: String,
}

/// Content of an archive.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Id of the order.
    pub order: String,
    /// Lines of the log.
    pub lines: Vec<Line>,
    /// All files but readme, log and manifest.
    pub files: Vec<File>,
}

/// Content of `manifest.json`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Manifest {
    pub(super) version: u32,
    pub(super) order: String,
    /// SHA-256 by name.
    pub(super) files: BTreeMap<String, String>,
    pub(super) log: LogHead,
}

/// Length of the log, with the hash of its last entry.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LogHead {
    pub(super) entries: i64,
    pub(super) last_sha256: String,
}

/// Writes the archive.
///
/// # Errors
/// Fails when memory is exhausted.
pub fn archive(evidence: Evidence) -> anyhow::Result<Vec<u8>> {
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
        last_sha256: last.sha256.clone(),
    };
    let mut files = evidence.files;
    let file = |name: &str, text: &str| File {
        name: name.to_owned(),
        bytes: text.as_bytes().to_vec(),
    };
    files.push(file("README.txt", super::README));
    files.push(file("entries.ndjson", &log));
    files.sort_by(|a, b| a.name.cmp(&b.name));
    let manifest = Manifest {
        version: 1,
        order: evidence.order,
        files: files
            .iter()
            .map(|file| (file.name.clone(), sha256_hex(&file.bytes)))
            .collect(),
        log: head,
    };
    files.push(file(
        "manifest.json",
        &serde_json::to_string_pretty(&manifest)?,
    ));
    write(&files)
}

/// Packs files in this order; the same files give the same bytes.
pub(super) fn write(files: &[File]) -> anyhow::Result<Vec<u8>> {
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
