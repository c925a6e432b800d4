//! A separate database for every test.

use anyhow::{Context, Result};
use sqlx::{AssertSqlSafe, Connection, Executor, PgConnection};
use std::path::Path;
use uuid::Uuid;

/// The two kinds of database.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// A file.
    Sqlite,
    /// A database on the server of `BINNACLE_TEST_POSTGRES`.
    Postgres,
}

/// An empty database, for the server's `--database-url`.
#[derive(Debug)]
pub struct Database {
    url: String,
    /// URL of the PostgreSQL server, and the database's name there.
    created: Option<(String, String)>,
}

impl Database {
    /// Creates a database; an SQLite file lies in `folder`.
    ///
    /// # Errors
    /// Without PostgreSQL: tests are never skipped for that.
    pub async fn create(engine: Engine, folder: &Path) -> Result<Database> {
        if engine == Engine::Sqlite {
            let file = folder.join("binnacle.db");
            return Ok(Database {
                url: format!("sqlite://{}", file.display()),
                created: None,
            });
        }
        let server = std::env::var("BINNACLE_TEST_POSTGRES").context(
            "BINNACLE_TEST_POSTGRES names no PostgreSQL server: run `make test`, which starts \
             one, or `scripts/with-postgres cargo test`",
        )?;
        let name = format!("binnacle_{}", Uuid::now_v7().simple());
        let mut connection = PgConnection::connect(&server).await.context("PostgreSQL")?;
        connection
            .execute(AssertSqlSafe(format!("CREATE DATABASE {name}")))
            .await?;
        Ok(Database {
            url: with_database(&server, &name)?,
            created: Some((server, name)),
        })
    }

    /// Names a database that somebody else made and removes.
    pub fn at(url: String) -> Database {
        Database { url, created: None }
    }

    /// The URL for `--database-url`.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Removes the database. A failed test leaves it for inspection.
    ///
    /// # Errors
    /// Fails when PostgreSQL refuses.
    pub async fn remove(self) -> Result<()> {
        let Some((server, name)) = self.created else {
            return Ok(());
        };
        let mut connection = PgConnection::connect(&server).await?;
        let drop = format!("DROP DATABASE {name} WITH (FORCE)");
        connection.execute(AssertSqlSafe(drop)).await?;
        Ok(())
    }
}

/// Returns the server's URL with another database in its path.
fn with_database(server: &str, name: &str) -> Result<String> {
    let mut url = reqwest::Url::parse(server).context("BINNACLE_TEST_POSTGRES")?;
    url.set_path(name);
    Ok(url.into())
}
