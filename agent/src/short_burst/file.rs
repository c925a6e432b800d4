//! A modem made of two folders: sent messages as files, received messages as files. For tests, and
//! for the program on board that drives the real modem.

use super::Modem;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Size limit of a received message.
const MAX_MESSAGE_BYTES: u64 = 1_960;
const EXTENSION: &str = "sbd";

/// Writes `out/NUMBER.sbd`, and reads and removes `in/*.sbd`, in the order of their names.
#[derive(Debug)]
pub(crate) struct FileModem {
    outbox: PathBuf,
    inbox: PathBuf,
}

impl FileModem {
    /// Opens the modem, creating its folders if necessary.
    pub(crate) fn open(directory: &Path) -> io::Result<FileModem> {
        let modem = FileModem {
            outbox: directory.join("out"),
            inbox: directory.join("in"),
        };
        fs::create_dir_all(&modem.outbox)?;
        fs::create_dir_all(&modem.inbox)?;
        Ok(modem)
    }

    /// Writes a message. The file is complete before it gets its name, and on the disk before it
    /// counts as sent. Numbers always rise, even when earlier files were removed.
    fn write(&self, message: &[u8]) -> io::Result<()> {
        let counter = self.outbox.join("next");
        let stated = fs::read_to_string(&counter).ok();
        let stated = stated.and_then(|text| text.trim().parse().ok());
        let last = messages(&self.outbox)?
            .into_iter()
            .filter_map(|path| number(&path));
        let free = last.max().map_or(1, |last: u64| last.saturating_add(1));
        let number = stated.unwrap_or(1).max(free);
        let next = format!("{}\n", number.saturating_add(1));
        self.replace_file(&counter, next.as_bytes())?;
        self.replace_file(
            &self.outbox.join(format!("{number:08}.{EXTENSION}")),
            message,
        )?;
        File::open(&self.outbox)?.sync_all()
    }

    /// Replaces a file without following links: another user may have placed one there.
    fn replace_file(&self, path: &Path, content: &[u8]) -> io::Result<()> {
        let partial = self.outbox.join("partial");
        if fs::symlink_metadata(&partial).is_ok() {
            fs::remove_file(&partial)?;
        }
        let mut file = File::create_new(&partial)?;
        file.write_all(content)?;
        file.sync_all()?;
        fs::rename(&partial, path)
    }

    fn read(&self) -> io::Result<Option<Vec<u8>>> {
        let Some(path) = messages(&self.inbox)?.into_iter().next() else {
            return Ok(None);
        };
        let mut message = Vec::new();
        File::open(&path)?
            .take(MAX_MESSAGE_BYTES)
            .read_to_end(&mut message)?;
        fs::remove_file(&path)?;
        Ok(Some(message))
    }
}

impl Modem for FileModem {
    async fn send(&mut self, message: &[u8]) -> io::Result<()> {
        self.write(message)
    }

    async fn receive(&mut self) -> io::Result<Option<Vec<u8>>> {
        self.read()
    }
}

fn messages(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == EXTENSION) && path.is_file() {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

fn number(path: &Path) -> Option<u64> {
    path.file_stem()?.to_str()?.parse().ok()
}
