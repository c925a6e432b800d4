//! Online copy of a SQLite database [sqlite.org, "Using the SQLite Online Backup API", and
//! "VACUUM", VACUUM INTO].

use super::MIGRATIONS_TABLE;
use anyhow::{Context, Result, ensure};
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{Connection, query, query_scalar};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Returns the file of a database.
pub(super) fn place(url: &str) -> Result<PathBuf> {
    let options = SqliteConnectOptions::from_str(url)
        .with_context(|| format!("{url:?} is not a SQLite URL"))?;
    Ok(options.get_filename().to_owned())
}

/// Copies a database, as of one moment, into an empty file.
pub(super) async fn copy(url: &str, into: &Path) -> Result<()> {
    let from = place(url)?;
    let into = into.to_str().context("the file's name is not UTF-8")?;
    let mut connection = open(&from).await?;
    // Copying mends an index that does not fit its table, and so hides damage.
    must_be_whole(&mut connection, &from, "PRAGMA quick_check(1)").await?;
    query("VACUUM INTO $1")
        .bind(into)
        .execute(&mut connection)
        .await
        .with_context(|| format!("cannot copy {}", from.display()))?;
    connection.close().await?;
    Ok(())
}

/// Checks that a file is a whole database of ours.
pub(super) async fn check(file: &Path) -> Result<()> {
    let damaged = || format!("{} is damaged", file.display());
    let mut connection = open(file).await.with_context(damaged)?;
    must_be_whole(&mut connection, file, "PRAGMA integrity_check(1)").await?;
    let tables: i64 = query_scalar("SELECT COUNT(*) FROM sqlite_schema WHERE name = $1")
        .bind(MIGRATIONS_TABLE)
        .fetch_one(&mut connection)
        .await
        .with_context(damaged)?;
    ensure!(
        tables == 1,
        "{} has no data of binnacle-server",
        file.display()
    );
    connection.close().await?;
    Ok(())
}

async fn must_be_whole(
    connection: &mut SqliteConnection,
    file: &Path,
    check: &'static str,
) -> Result<()> {
    let damaged = || format!("{} is damaged", file.display());
    let found: Vec<String> = query_scalar(check)
        .fetch_all(connection)
        .await
        .with_context(damaged)?;
    ensure!(found == ["ok"], "{}: {}", damaged(), found.join(", "));
    Ok(())
}

async fn open(file: &Path) -> Result<SqliteConnection> {
    let options = SqliteConnectOptions::new().filename(file).read_only(true);
    SqliteConnection::connect_with(&options)
        .await
        .with_context(|| format!("{} is damaged or cannot be read", file.display()))
}
