//! `verify-evidence`: checks an archive of evidence by its own content alone.

use super::{BadInput, print_result};
use crate::cli::VerifyEvidence;
use binnacle_orders::evidence::{self, Findings};
use std::fs;
use std::process::ExitCode;

/// Prints the facts of the archive, or its problems.
///
/// # Errors
/// Fails when standard output cannot be written to.
pub fn verify_evidence(arguments: &VerifyEvidence) -> anyhow::Result<ExitCode> {
    let file = arguments.file.display();
    let checked = fs::read(&arguments.file)
        .map_err(|error| BadInput(format!("{file}: {error}")))
        .and_then(|bytes| describe(&file.to_string(), &evidence::verify(&bytes)));
    print_result(checked)
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
