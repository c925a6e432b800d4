//! Atomic replacement of files.

use anyhow::Context;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes beside the file and then renames, so that a partial table never looks complete.
///
/// # Errors
/// Fails when `content` fails, or when the file cannot be written.
pub(crate) fn write_atomically<T>(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let name = || path.display().to_string();
    if is_device(path) {
        let mut file = fs::OpenOptions::new()
            .write(true)
            .open(path)
            .with_context(name)?;
        return content(&mut file);
    }
    let mut partial = path.as_os_str().to_owned();
    partial.push(".partial");
    let partial = PathBuf::from(partial);
    let mut file = BufWriter::new(File::create(&partial).with_context(name)?);
    let result = content(&mut file)?;
    let finish = || -> std::io::Result<()> {
        let file = file.into_inner()?;
        file.sync_all()?;
        fs::rename(&partial, path)
    };
    finish().with_context(name)?;
    Ok(result)
}

/// Returns whether the path is a device. /dev/stdout may stand for a file, but not for one that can
/// be renamed to.
fn is_device(path: &Path) -> bool {
    path.starts_with("/dev")
        || path.starts_with("/proc")
        || fs::metadata(path).is_ok_and(|found| !found.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    #[test]
    fn a_table_takes_the_place_of_a_file_and_never_of_a_device() {
        let directory = TempDir::new().unwrap();
        let path = directory.path().join("samples.csv");
        for table in [b"a longer table".as_slice(), b"a table"] {
            write_atomically(&path, |out| Ok(out.write_all(table)?)).unwrap();
            assert_eq!(fs::read(&path).unwrap(), table);
        }
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
        assert!(!is_device(&path));
        for device in ["/dev/null", "/dev/stdout", "/proc/self/fd/1"] {
            assert!(is_device(Path::new(device)), "{device}");
        }
    }

    #[test]
    fn what_fails_half_way_leaves_the_file_as_it_was() {
        let directory = TempDir::new().unwrap();
        let path = directory.path().join("samples.csv");
        fs::write(&path, "before").unwrap();
        let failed: anyhow::Result<()> = write_atomically(&path, |out| {
            out.write_all(b"half")?;
            anyhow::bail!("no more")
        });
        assert_eq!(failed.unwrap_err().to_string(), "no more");
        assert_eq!(fs::read(&path).unwrap(), b"before");
    }
}
