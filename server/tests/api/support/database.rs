//! A database of its own for each test.

use sqlx::{AssertSqlSafe, Connection, Executor, PgConnection};
use tempfile::TempDir;
use uuid::Uuid;

#[derive(Clone, Copy, Debug)]
pub(crate) enum Engine {
    Sqlite,
    Postgres,
}

pub(super) struct Database {
    pub(super) url: String,
    kind: Kind,
}

enum Kind {
    File(#[allow(dead_code, reason = "removed when it goes")] TempDir),
    Server { admin_url: String, name: String },
}

impl Database {
    pub(super) async fn new(engine: Engine) -> Database {
        match engine {
            Engine::Sqlite => {
                let folder = tempfile::tempdir().unwrap();
                Database {
                    url: format!("sqlite://{}/test.db", folder.path().display()),
                    kind: Kind::File(folder),
                }
            }
            Engine::Postgres => {
                let admin_url = std::env::var("BINNACLE_TEST_POSTGRES").expect(
                    "BINNACLE_TEST_POSTGRES names no server: run `make test`, or \
                     `scripts/with-postgres cargo test -p binnacle-server`",
                );
                let name = format!("test_{}", Uuid::now_v7().simple());
                run(&admin_url, format!("CREATE DATABASE {name}")).await;
                let (server, _) = admin_url.rsplit_once('/').unwrap();
                Database {
                    url: format!("{server}/{name}"),
                    kind: Kind::Server { admin_url, name },
                }
            }
        }
    }

    pub(super) async fn remove(self) {
        if let Kind::Server { admin_url, name } = self.kind {
            run(&admin_url, format!("DROP DATABASE {name} WITH (FORCE)")).await;
        }
    }
}

async fn run(url: &str, sql: String) {
    let mut connection = PgConnection::connect(url).await.unwrap();
    connection.execute(AssertSqlSafe(sql)).await.unwrap();
    connection.close().await.unwrap();
}
