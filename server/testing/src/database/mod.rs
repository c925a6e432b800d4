//! A separate database for each test.
//!
//! Migrations run once, on a template that each test's database is a copy of. Running them
//! for each of hundreds of tests would take minutes.

mod proxy;

pub use proxy::Proxy;

use binnacle_platform::db::Db;
use binnacle_server::subscriptions::subscribers;
use sqlx::{AssertSqlSafe, Connection, Executor, PgConnection};
use tempfile::TempDir;
use tokio::sync::OnceCell;
use uuid::Uuid;

/// Database engine of a test.
#[derive(Clone, Copy, Debug)]
pub enum Engine {
    /// A file of its own.
    Sqlite,
    /// A database of its own on the server.
    Postgres,
}

const FILE: &str = "test.db";

pub(crate) struct Database {
    pub(crate) url: String,
    kind: Kind,
}

enum Kind {
    File(#[allow(dead_code, reason = "removed when it goes")] TempDir),
    Server { admin_url: String, name: String },
}

/// Bytes of the migrated SQLite file that each test copies.
static FILE_PATTERN: OnceCell<Vec<u8>> = OnceCell::const_new();
/// Name of the migrated PostgreSQL database that each test copies.
static SERVER_PATTERN: OnceCell<String> = OnceCell::const_new();

impl Database {
    /// Creates a database with every table, all empty.
    pub(crate) async fn new(engine: Engine) -> Database {
        match engine {
            Engine::Sqlite => {
                let pattern = FILE_PATTERN.get_or_init(file_pattern).await;
                let folder = tempfile::tempdir().unwrap();
                std::fs::write(folder.path().join(FILE), pattern).unwrap();
                Database::file(folder)
            }
            Engine::Postgres => {
                let pattern = SERVER_PATTERN.get_or_init(server_pattern).await;
                Database::on_server(&format!(" TEMPLATE {pattern}")).await
            }
        }
    }

    /// Creates a database without any table.
    pub(crate) async fn bare(engine: Engine) -> Database {
        match engine {
            Engine::Sqlite => Database::file(tempfile::tempdir().unwrap()),
            Engine::Postgres => Database::on_server("").await,
        }
    }

    fn file(folder: TempDir) -> Database {
        Database {
            url: format!("sqlite://{}/{FILE}", folder.path().display()),
            kind: Kind::File(folder),
        }
    }

    async fn on_server(pattern: &str) -> Database {
        let admin_url = std::env::var("BINNACLE_TEST_POSTGRES").expect(
            "BINNACLE_TEST_POSTGRES names no server: run `make test`, or \
             `scripts/with-postgres cargo test -p binnacle-server`",
        );
        let name = format!("test_{}", Uuid::now_v7().simple());
        run(&admin_url, format!("CREATE DATABASE {name}{pattern}")).await;
        let (server, _) = admin_url.rsplit_once('/').unwrap();
        Database {
            url: format!("{server}/{name}"),
            kind: Kind::Server { admin_url, name },
        }
    }

    /// Changes the URL to that of a new proxy in front of the database.
    pub(crate) async fn connect_through_proxy(&mut self) -> Proxy {
        let (login, place) = self.url.rsplit_once('@').unwrap();
        let (address, name) = place.split_once('/').unwrap();
        let proxy = Proxy::start(address.parse().unwrap()).await;
        self.url = format!("{login}@127.0.0.1:{}/{name}", proxy.port());
        proxy
    }

    pub(crate) async fn remove(self) {
        if let Kind::Server { admin_url, name } = self.kind {
            run(&admin_url, format!("DROP DATABASE {name} WITH (FORCE)")).await;
        }
    }
}

async fn file_pattern() -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(FILE);
    migrate(&format!("sqlite://{}", file.display())).await;
    std::fs::read(file).unwrap()
}

async fn server_pattern() -> String {
    let database = Database::on_server("").await;
    migrate(&database.url).await;
    let (_, name) = database.url.rsplit_once('/').unwrap();
    name.to_owned()
}

/// Runs all migrations and closes the connection.
async fn migrate(url: &str) {
    let db = Db::connect(url, subscribers()).await.unwrap();
    db.migrate().await.unwrap();
    db.close().await;
}

async fn run(url: &str, sql: String) {
    let mut connection = PgConnection::connect(url).await.unwrap();
    connection.execute(AssertSqlSafe(sql)).await.unwrap();
    connection.close().await.unwrap();
}
