//! Backups of the database: SQLite's own online copy, PostgreSQL's own dump.
//!
//! Invariants:
//!
//! - A backup holds all that was acknowledged before it began, and the server goes on meanwhile.
//! - A file has its name only once it is whole, checked and on disk. Until then it ends in `.part`.
//! - A backup is restored into an empty database only, and as a whole or not at all.

mod postgres;
mod sqlite;

use anyhow::{Context, Result, bail, ensure};
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

/// First bytes of a backup of each engine: a SQLite file, and an archive of `pg_dump`.
const SQLITE_MAGIC: &[u8] = b"SQLite format 3\0";
const POSTGRES_MAGIC: &[u8] = b"PGDMP";
/// Table without which a file is no backup of ours.
const MIGRATIONS_TABLE: &str = "_sqlx_migrations";

/// Engine of a database or a backup.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Engine {
    Sqlite,
    Postgres,
}

impl Engine {
    fn of_url(url: &str) -> Result<Engine> {
        match url.split_once(':') {
            Some(("sqlite", _)) => Ok(Engine::Sqlite),
            Some(("postgres" | "postgresql", _)) => Ok(Engine::Postgres),
            _ => bail!("the database URL begins neither with sqlite: nor with postgres:"),
        }
    }

    fn of_backup(file: &Path) -> Result<Engine> {
        let mut begin = Vec::new();
        let opened = File::open(file).with_context(|| format!("cannot read {}", file.display()))?;
        opened.take(32).read_to_end(&mut begin)?;
        if begin.starts_with(SQLITE_MAGIC) {
            Ok(Engine::Sqlite)
        } else if begin.starts_with(POSTGRES_MAGIC) {
            Ok(Engine::Postgres)
        } else {
            bail!("{} is no backup of binnacle-server", file.display())
        }
    }

    fn name(self) -> &'static str {
        match self {
            Engine::Sqlite => "SQLite",
            Engine::Postgres => "PostgreSQL",
        }
    }
}

/// Copies a database into a new file, and returns the file's size in bytes.
///
/// # Errors
/// Fails when the file exists, the database cannot be read, `pg_dump` is not installed, or the
/// copy does not pass its check.
pub async fn back_up(url: &str, file: &Path) -> Result<u64> {
    let engine = Engine::of_url(url)?;
    ensure!(!file.exists(), "{} exists already", file.display());
    let part = Part::create(file)?;
    match engine {
        Engine::Sqlite => {
            sqlite::copy(url, part.path()).await?;
            sqlite::check(part.path()).await?;
        }
        Engine::Postgres => {
            postgres::dump(url, part.path()).await?;
            postgres::check(part.path()).await?;
        }
    }
    part.publish()
}

/// Restores a backup into an empty database.
///
/// # Errors
/// Fails when the backup is damaged or of another engine, the database is not empty, or
/// `pg_restore` is not installed. The database is as it was then.
pub async fn restore(url: &str, file: &Path) -> Result<()> {
    let (target, source) = (Engine::of_url(url)?, Engine::of_backup(file)?);
    ensure!(
        target == source,
        "{} is a backup of {}, and the database is one of {}",
        file.display(),
        source.name(),
        target.name()
    );
    match target {
        Engine::Sqlite => {
            sqlite::check(file).await?;
            let place = sqlite::place(url)?;
            ensure!(
                !place.exists(),
                "{} exists already: a backup is restored into a new file",
                place.display()
            );
            let part = Part::create(&place)?;
            part.fill(file)?;
            sqlite::check(part.path()).await?;
            part.publish()?;
        }
        Engine::Postgres => {
            postgres::check(file).await?;
            postgres::restore(url, file).await?;
        }
    }
    Ok(())
}

/// File that is being written; removed unless published.
struct Part {
    part: PathBuf,
    file: PathBuf,
}

impl Part {
    /// Creates the file beside its final place, for its owner alone: it holds every secret of the
    /// server.
    fn create(file: &Path) -> Result<Part> {
        let mut part = file.as_os_str().to_owned();
        part.push(".part");
        let part = PathBuf::from(part);
        let created = OpenOptions::new()
            .write(true)
            .create_new(true)
            .mode(0o600)
            .open(&part);
        match created {
            Ok(_) => Ok(Part {
                part,
                file: file.to_owned(),
            }),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => bail!(
                "{} exists: another backup or restore is under way, or one was interrupted; then remove it",
                part.display()
            ),
            Err(error) => Err(error).with_context(|| format!("cannot write {}", part.display())),
        }
    }

    /// Copies a file's content. The copy stays its owner's, whoever may read the file.
    fn fill(&self, from: &Path) -> Result<()> {
        let mut into = OpenOptions::new().write(true).open(&self.part)?;
        let copied = File::open(from).and_then(|mut from| std::io::copy(&mut from, &mut into));
        copied.with_context(|| format!("cannot copy {}", from.display()))?;
        Ok(())
    }

    fn path(&self) -> &Path {
        &self.part
    }

    /// Gives the file its name, on disk, and returns its size in bytes. Nothing is replaced.
    fn publish(self) -> Result<u64> {
        let written = File::open(&self.part)?;
        written.sync_all()?;
        std::fs::hard_link(&self.part, &self.file)
            .with_context(|| format!("cannot name it {}", self.file.display()))?;
        let folder = self.file.parent().filter(|folder| *folder != Path::new(""));
        File::open(folder.unwrap_or(Path::new(".")))?.sync_all()?;
        Ok(written.metadata()?.len())
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        // What cannot be removed is named at the next attempt.
        let _ = std::fs::remove_file(&self.part);
    }
}
