//! A modem that is two folders: messages out as files, answers in as files. For tests,
//! and for whatever program of the ship's speaks to the real one.

use super::Modem;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Longer files are no messages.
const LONGEST: u64 = 1_960;
const ENDING: &str = "sbd";

/// Writes `out/NUMBER.sbd`, and reads and removes `in/*.sbd`, in the order of their names.
#[derive(Debug)]
pub(crate) struct FileModem {
    out: PathBuf,
    answers: PathBuf,
}

impl FileModem {
    /// Makes the folders if need be.
    pub(crate) fn open(directory: &Path) -> io::Result<FileModem> {
        let modem = FileModem {
            out: directory.join("out"),
            answers: directory.join("in"),
        };
        fs::create_dir_all(&modem.out)?;
        fs::create_dir_all(&modem.answers)?;
        Ok(modem)
    }

    /// Whole before it has its name, and on the disk before it counts as sent. Numbers
    /// rise, also when those before have been taken away.
    fn write(&self, message: &[u8]) -> io::Result<()> {
        let counter = self.out.join("next");
        let stated = fs::read_to_string(&counter).ok();
        let stated = stated.and_then(|text| text.trim().parse().ok());
        let last = messages(&self.out)?
            .into_iter()
            .filter_map(|path| number(&path));
        let free = last.max().map_or(1, |last: u64| last.saturating_add(1));
        let number = stated.unwrap_or(1).max(free);
        let next = format!("{}\n", number.saturating_add(1));
        self.put(&counter, next.as_bytes())?;
        self.put(&self.out.join(format!("{number:08}.{ENDING}")), message)?;
        File::open(&self.out)?.sync_all()
    }

    /// Never through a link that somebody laid in the agent's way: what has a name is
    /// replaced, not written to.
    fn put(&self, path: &Path, content: &[u8]) -> io::Result<()> {
        let partial = self.out.join("partial");
        if fs::symlink_metadata(&partial).is_ok() {
            fs::remove_file(&partial)?;
        }
        let mut file = File::create_new(&partial)?;
        file.write_all(content)?;
        file.sync_all()?;
        fs::rename(&partial, path)
    }

    fn read(&self) -> io::Result<Option<Vec<u8>>> {
        let Some(path) = messages(&self.answers)?.into_iter().next() else {
            return Ok(None);
        };
        let mut message = Vec::new();
        File::open(&path)?.take(LONGEST).read_to_end(&mut message)?;
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
        if path.extension().is_some_and(|ending| ending == ENDING) && path.is_file() {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

fn number(path: &Path) -> Option<u64> {
    path.file_stem()?.to_str()?.parse().ok()
}
