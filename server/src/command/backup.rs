//! `backup` and `restore`.

use super::operate::block_on;
use super::print;
use crate::backup;
use crate::cli::Backup;
use anyhow::Result;
use std::process::ExitCode;
use std::time::Instant;

/// Copies the database into a file.
///
/// # Errors
/// Fails when the database cannot be read or the file cannot be written.
pub fn back_up(arguments: &Backup) -> Result<ExitCode> {
    let begun = Instant::now();
    let (url, file) = (&arguments.database.database_url, &arguments.file);
    let bytes = block_on(backup::back_up(url, file))?;
    let (size_mb, took_s) = (bytes as f64 / 1e6, begun.elapsed().as_secs_f64());
    let file = file.display();
    print(&format!(
        "{file}: {size_mb:.1} MB in {took_s:.1} s, checked"
    ))?;
    Ok(ExitCode::SUCCESS)
}

/// Restores a backup into an empty database.
///
/// # Errors
/// Fails when the backup is damaged or the database is not empty.
pub fn restore(arguments: &Backup) -> Result<ExitCode> {
    let (url, file) = (&arguments.database.database_url, &arguments.file);
    block_on(backup::restore(url, file))?;
    print(&format!("{} is restored", file.display()))?;
    Ok(ExitCode::SUCCESS)
}
