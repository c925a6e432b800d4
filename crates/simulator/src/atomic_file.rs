//! Files that are written completely or not at all.

use crate::cli::BadInput;
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Path of the unfinished file, renamed when complete; devices and pipes are
/// written directly.
pub(crate) fn partial_path(out: &Path) -> PathBuf {
    // /dev/stdout may lead to a file, but a rename must not replace it.
    let is_device = out.starts_with("/dev")
        || out.starts_with("/proc")
        || std::fs::metadata(out).is_ok_and(|found| !found.is_file());
    if is_device {
        return out.to_owned();
    }
    let mut name = out.as_os_str().to_owned();
    name.push(".partial");
    PathBuf::from(name)
}

pub(crate) fn finish(partial: &Path, out: &Path) -> Result<()> {
    if partial == out {
        return Ok(());
    }
    std::fs::rename(partial, out).map_err(|error| bad_path(out, &error).into())
}

/// Writes a file completely or not at all.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let partial = partial_path(path);
    std::fs::write(&partial, bytes).map_err(|error| bad_path(path, &error))?;
    finish(&partial, path)
}

pub(crate) fn bad_path(path: &Path, error: &std::io::Error) -> BadInput {
    BadInput(format!("{}: {error}", path.display()))
}
