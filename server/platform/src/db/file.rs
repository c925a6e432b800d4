//! The file of a SQLite database.
//!
//! Invariants: the file is for its owner's eyes alone. One process at a time serves it or changes its
//! schema; whoever does holds a lock on the file beside it, which ends with the process.

use super::{Db, Pools};
use anyhow::{Context, Result, anyhow, bail, ensure};
use sqlx::SqlitePool;
use std::fmt::Display;
use std::fs::{File, OpenOptions, Permissions, TryLockError};
use std::io::{Read, Write};
use std::os::unix::fs::{OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Mode of the file: its owner reads and writes it.
const OWNERS: u32 = 0o600;
/// Word in the lock's file while a server holds it.
const SERVING: &str = "serve";
/// Word in the lock's file while the schema is changed.
const MIGRATING: &str = "migrate";
/// Longest wait for a change of the schema by another process.
const PATIENCE: Duration = Duration::from_mins(10);
/// Interval between attempts to get the lock.
pub(super) const TRY_EVERY: Duration = Duration::from_millis(50);

/// Right to serve a database or to change its schema. On PostgreSQL several processes may.
#[derive(Debug)]
pub struct Claim {
    _lock: Option<File>,
}

impl Db {
    /// Claims the database for a server, until the claim is dropped.
    ///
    /// # Errors
    /// Fails when another process serves the same SQLite file.
    pub async fn claim_to_serve(&self) -> Result<Claim> {
        self.claim(SERVING).await
    }

    /// Claims the database for a change of its schema.
    pub(super) async fn claim_to_migrate(&self) -> Result<Claim> {
        self.claim(MIGRATING).await
    }

    async fn claim(&self, purpose: &str) -> Result<Claim> {
        let Some(file) = self.sqlite_file() else {
            return Ok(Claim { _lock: None });
        };
        let lock = beside(&file, "-lock");
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false);
        let mut held = options
            .mode(OWNERS)
            .open(&lock)
            .with_context(|| format!("cannot open {}", lock.display()))?;
        let since = tokio::time::Instant::now();
        let mut refused = 0;
        loop {
            match held.try_lock() {
                Ok(()) => break,
                Err(TryLockError::Error(error)) => {
                    return Err(error).with_context(|| format!("cannot lock {}", lock.display()));
                }
                Err(TryLockError::WouldBlock) => {}
            }
            let mut holder = String::new();
            File::open(&lock)?.take(100).read_to_string(&mut holder)?;
            // A holder writes its word just after it has got the lock.
            refused += i32::from(holder.starts_with(SERVING));
            if refused > 1 {
                bail!(
                    "another binnacle-server serves {}: stop it first",
                    file.display()
                );
            }
            ensure!(
                since.elapsed() < PATIENCE,
                "another process is changing the schema of {}",
                file.display()
            );
            tokio::time::sleep(TRY_EVERY).await;
        }
        held.set_len(0)?;
        held.write_all(purpose.as_bytes())?;
        Ok(Claim { _lock: Some(held) })
    }

    /// Checks that a SQLite file is whole [sqlite.org, "PRAGMA quick_check"]. PostgreSQL checks its
    /// own files.
    ///
    /// # Errors
    /// Says what is damaged.
    pub async fn check_file(&self) -> Result<()> {
        let (Pools::Sqlite { writer, .. }, Some(file)) = (self.pools(), self.sqlite_file()) else {
            return Ok(());
        };
        let checked = sqlx::query_scalar("PRAGMA quick_check(1)");
        let found: Vec<String> = match checked.fetch_all(writer).await {
            Err(error) if is_damage(&error) => return Err(damaged(&file, error)),
            found => found?,
        };
        if found != ["ok"] {
            return Err(damaged(&file, found.join(", ")));
        }
        Ok(())
    }

    fn sqlite_file(&self) -> Option<PathBuf> {
        match self.pools() {
            Pools::Sqlite { writer, .. } => Some(file_of(writer)),
            Pools::Postgres(_) => None,
        }
    }
}

/// Returns the error about a damaged file.
pub(super) fn damaged(file: &Path, detail: impl Display) -> anyhow::Error {
    anyhow!("{} is damaged: restore a backup ({detail})", file.display())
}

/// Checks for the errors that SQLite has for a damaged file [sqlite.org, "Result and Error Codes":
/// SQLITE_CORRUPT and SQLITE_NOTADB].
pub(super) fn is_damage(error: &sqlx::Error) -> bool {
    matches!(primary_code(error), Some(11 | 26))
}

/// Checks for the error that SQLite has for a lock of another process (SQLITE_BUSY).
pub(super) fn is_busy(error: &sqlx::Error) -> bool {
    primary_code(error) == Some(5)
}

fn primary_code(error: &sqlx::Error) -> Option<u32> {
    let code = error
        .as_database_error()
        .and_then(sqlx::error::DatabaseError::code);
    Some(code?.parse::<u32>().ok()? & 0xff)
}

fn file_of(pool: &SqlitePool) -> PathBuf {
    pool.connect_options().get_filename().to_owned()
}

fn beside(file: &Path, ending: &str) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(ending);
    PathBuf::from(name)
}

/// Creates the file for its owner alone if it is missing, and takes away what others may do with
/// it. SQLite gives its other files the same mode.
pub(super) fn make_private(file: &Path) -> Result<()> {
    let cannot = || format!("cannot open {}", file.display());
    let mut options = OpenOptions::new();
    let options = options.read(true).write(true).create(true).truncate(false);
    let opened = options.mode(OWNERS).open(file).with_context(cannot)?;
    let mode = opened.metadata()?.permissions().mode() & 0o777;
    if mode & !OWNERS != 0 {
        opened
            .set_permissions(Permissions::from_mode(mode & OWNERS))
            .with_context(|| format!("{} is readable by others", file.display()))?;
        for ending in ["-wal", "-shm"] {
            let other = beside(file, ending);
            if other.exists() {
                std::fs::set_permissions(other, Permissions::from_mode(mode & OWNERS))?;
            }
        }
    }
    Ok(())
}
