//! `verify-evidence`: checks an archive of evidence by its own content and the server's keys.

use super::{BadInput, print_result};
use crate::cli::VerifyEvidence;
use binnacle_orders::evidence::{self, Findings};
use binnacle_platform::signing_keys::{PublishedKey, PublishedKeys};
use std::fs;
use std::path::Path;
use std::process::ExitCode;

/// Prints the facts of the archive, or its problems.
///
/// # Errors
/// Fails when standard output cannot be written to.
pub fn verify_evidence(arguments: &VerifyEvidence) -> anyhow::Result<ExitCode> {
    print_result(check(arguments))
}

fn check(arguments: &VerifyEvidence) -> Result<String, BadInput> {
    let keys = arguments.keys.as_deref().map(read_keys).transpose()?;
    let file = arguments.file.display().to_string();
    let bytes = read(&arguments.file)?;
    describe(&file, &evidence::verify(&bytes, keys.as_deref()))
}

fn read(file: &Path) -> Result<Vec<u8>, BadInput> {
    fs::read(file).map_err(|error| BadInput(format!("{}: {error}", file.display())))
}

/// Reads the list of keys that a server publishes.
fn read_keys(file: &Path) -> Result<Vec<PublishedKey>, BadInput> {
    let keys: PublishedKeys = serde_json::from_slice(&read(file)?).map_err(|error| {
        BadInput(format!(
            "{}: {error}: give the answer to GET /api/v1/signing-keys",
            file.display()
        ))
    })?;
    Ok(keys.items)
}

fn describe(file: &str, found: &Findings) -> Result<String, BadInput> {
    if !found.problems.is_empty() {
        return Err(BadInput(format!("{file}: {}", found.problems.join("; "))));
    }
    let mut lines = vec![format!(
        "{file}: whole and unchanged. A prediction and its evidence, not a certificate."
    )];
    lines.extend(found.facts.iter().map(|fact| format!("- {fact}")));
    Ok(lines.join("\n"))
}
