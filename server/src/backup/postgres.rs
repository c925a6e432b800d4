//! Dump of a PostgreSQL database by `pg_dump`, restored by `pg_restore` [PostgreSQL 18
//! documentation, chapter 25.1 and the reference of both programs].

use super::MIGRATIONS_TABLE;
use anyhow::{Context, Result, bail, ensure};
use percent_encoding::percent_decode_str;
use reqwest::Url;
use sqlx::{Connection, PgConnection, query_scalar};
use std::io::ErrorKind;
use std::path::Path;
use std::process::Stdio;
use tokio::process::Command;

/// Dumps a database, as of one moment, into a file.
pub(super) async fn dump(url: &str, into: &Path) -> Result<()> {
    let mut command = program("pg_dump", url)?;
    command.arg("--format=custom").arg("--file").arg(into);
    run(command, "pg_dump").await?;
    Ok(())
}

/// Checks that a file is a whole dump of a database of ours.
pub(super) async fn check(file: &Path) -> Result<()> {
    // The list is at the begin; what follows is read to its end by a restore into nowhere.
    let mut command = Command::new("pg_restore");
    command.arg("--list").arg(file);
    let list = run(command, "pg_restore")
        .await
        .with_context(|| format!("{} is damaged", file.display()))?;
    ensure!(
        list.contains(MIGRATIONS_TABLE),
        "{} has no data of binnacle-server",
        file.display()
    );
    let mut command = Command::new("pg_restore");
    command.arg("--file=/dev/null").arg(file);
    run(command, "pg_restore")
        .await
        .with_context(|| format!("{} is damaged", file.display()))?;
    Ok(())
}

/// Restores a dump into a database without tables, in one transaction.
pub(super) async fn restore(url: &str, file: &Path) -> Result<()> {
    let mut connection = PgConnection::connect(url)
        .await
        .context("cannot connect to PostgreSQL")?;
    let tables: i64 = query_scalar(
        "SELECT COUNT(*) FROM pg_catalog.pg_tables WHERE schemaname = current_schema()",
    )
    .fetch_one(&mut connection)
    .await?;
    connection.close().await?;
    ensure!(
        tables == 0,
        "the database has {tables} tables already: a backup is restored into an empty one"
    );
    let mut command = program("pg_restore", url)?;
    command
        .args(["--single-transaction", "--exit-on-error"])
        .args(["--no-owner", "--no-privileges"])
        .arg(file);
    run(command, "pg_restore").await?;
    Ok(())
}

/// Prepares a program of PostgreSQL. The password goes by the environment: everybody may read a
/// command line.
fn program(name: &str, url: &str) -> Result<Command> {
    let mut url: Url = url.parse().context("the database URL is no URL")?;
    let mut command = Command::new(name);
    if let Some(password) = url.password() {
        let password = percent_decode_str(password).decode_utf8()?.into_owned();
        command.env("PGPASSWORD", password);
        let removed = url.set_password(None);
        ensure!(removed.is_ok(), "the database URL has no host");
    }
    command.arg("--no-password").arg(format!("--dbname={url}"));
    Ok(command)
}

/// Runs a program and returns what it prints.
async fn run(mut command: Command, name: &str) -> Result<String> {
    let output = command
        .stdin(Stdio::null())
        .kill_on_drop(true)
        .output()
        .await;
    let output = match output {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            bail!("{name} was not found: install PostgreSQL's client programs")
        }
        output => output.with_context(|| format!("cannot run {name}"))?,
    };
    if !output.status.success() {
        let errors = String::from_utf8_lossy(&output.stderr);
        bail!("{}", errors.trim().replace('\n', "; "));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
