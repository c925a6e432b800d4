//! `verify-evidence`: checks an archive of evidence with nothing but what is in it.

use super::{BadInput, answer};
use crate::cli::VerifyEvidence;
use binnacle_orders::evidence::{self, Findings};
use std::fs;
use std::process::ExitCode;

/// Says what the archive is, or what is wrong with it.
///
/// # Errors
/// When standard output cannot be written to.
pub fn verify_evidence(arguments: &VerifyEvidence) -> anyhow::Result<ExitCode> {
    let file = arguments.file.display();
    let checked = fs::read(&arguments.file)
        .map_err(|error| BadInput(format!("{file}: {error}")))
        .and_then(|bytes| told(&file.to_string(), &evidence::verify(&bytes)));
    answer(checked)
}

fn told(file: &str, found: &Findings) -> Result<String, BadInput> {
    if !found.problems.is_empty() {
        return Err(BadInput(format!("{file}: {}", found.problems.join("; "))));
    }
    let mut lines = vec![format!(
        "{file}: whole and unchanged. A prediction and its evidence, not a certificate."
    )];
    lines.extend(found.facts.iter().map(|fact| format!("- {fact}")));
    Ok(lines.join("\n"))
}
