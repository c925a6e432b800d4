//! A running server for each test.

use crate::database::{Database, Engine, Proxy};
use binnacle_compass::time::Timestamp;
use binnacle_platform::app::App;
use binnacle_platform::clock::Clock;
use binnacle_platform::config::Serve;
use binnacle_platform::db::{Connection, Db, Pools};
use binnacle_server::cli::{Cli, Command};
use binnacle_server::subscriptions::subscribers;
use binnacle_server::worker::{self, Worked};
use binnacle_server::{backup, command, health};
use clap::Parser;
use metrics_exporter_prometheus::PrometheusHandle;
use std::path::Path;
use std::sync::OnceLock;
use tokio::net::TcpListener;
use tokio::task::JoinHandle;

/// Start time of every test.
pub const START: &str = "2026-11-21T07:00:00Z";
/// Seconds of a day.
pub const DAY_S: f64 = 86_400.0;
/// Seconds of an hour.
pub const HOUR_S: f64 = 3600.0;
/// Password of every person.
pub const PASSWORD: &str = "correct horse battery";

/// A running server with a clock that the test advances. Its worker does nothing by
/// itself: the test calls [`TestServer::work`].
pub struct TestServer {
    /// State of the server.
    pub app: App,
    /// Address, without a slash at the end.
    pub url: String,
    /// Client without a session.
    pub http: reqwest::Client,
    serving: JoinHandle<anyhow::Result<()>>,
    database: Database,
}

impl TestServer {
    /// Starts a server on an empty database.
    pub async fn start(engine: Engine) -> TestServer {
        TestServer::start_with(engine, &[]).await
    }

    /// Starts a server with more settings.
    pub async fn start_with(engine: Engine, settings: &[&str]) -> TestServer {
        let database = Database::new(engine).await;
        let clock = Clock::manual(Timestamp::parse(START).unwrap());
        TestServer::open(database, clock, settings).await
    }

    /// Starts a server on PostgreSQL behind a proxy, which the test may cut.
    pub async fn start_behind_proxy() -> (TestServer, Proxy) {
        let mut database = Database::new(Engine::Postgres).await;
        let proxy = database.connect_through_proxy().await;
        let clock = Clock::manual(Timestamp::parse(START).unwrap());
        (TestServer::open(database, clock, &[]).await, proxy)
    }

    /// Creates a migrated database, before the server opens it.
    pub async fn prepared(engine: Engine) -> Prepared {
        let prepared = TestServer::bare(engine).await;
        prepared.db.migrate().await.unwrap();
        prepared
    }

    /// Creates a database without any table, before the server opens it.
    pub async fn bare(engine: Engine) -> Prepared {
        let database = Database::bare(engine).await;
        let db = Db::connect(&database.url, subscribers()).await.unwrap();
        Prepared { db, database }
    }

    async fn open(database: Database, clock: Clock, settings: &[&str]) -> TestServer {
        let config = config(&database.url, settings);
        let db = config.database.open(subscribers()).await.unwrap();
        db.migrate().await.unwrap();
        let app = App::new(db, clock, config, metrics());
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}", listener.local_addr().unwrap());
        let serving = tokio::spawn(command::run(app.clone(), listener, None));
        TestServer {
            app,
            url,
            http: client(),
            serving,
            database,
        }
    }

    /// Stops the server and starts another on the same database.
    pub async fn restart(self) -> TestServer {
        self.restart_with(&[]).await
    }

    /// Stops the server and starts another with more settings on the same database.
    pub async fn restart_with(self, settings: &[&str]) -> TestServer {
        self.app.stopping.cancel();
        self.serving.await.unwrap().unwrap();
        TestServer::open(self.database, self.app.clock, settings).await
    }

    /// Starts a server on a backup restored into a new database.
    pub async fn restored(engine: Engine, file: &Path) -> TestServer {
        let database = Database::bare(engine).await;
        backup::restore(&database.url, file).await.unwrap();
        let clock = Clock::manual(Timestamp::parse(START).unwrap());
        TestServer::open(database, clock, &[]).await
    }

    /// Returns the URL of the database.
    pub fn database_url(&self) -> &str {
        &self.database.url
    }

    /// Stops the server and removes its database.
    pub async fn finish(self) {
        self.app.stopping.cancel();
        self.serving.await.unwrap().unwrap();
        self.database.remove().await;
    }

    /// Opens a second server on the same database, as another process would.
    pub async fn second_server(&self) -> App {
        let db = Db::connect(&self.database.url, subscribers())
            .await
            .unwrap();
        let config = config(&self.database.url, &[]);
        App::new(db, self.app.clock.clone(), config, metrics())
    }

    /// Opens the database again with other settings, as a server that starts does.
    pub async fn open_again(&self, settings: &[&str]) -> Db {
        let config = config(&self.database.url, settings);
        config.database.open(subscribers()).await.unwrap()
    }

    /// Runs SQL on the database without the server's knowledge.
    pub async fn run_sql(&self, statement: &'static str) {
        let mut tx = self.app.db.begin().await.unwrap();
        match tx.connection() {
            Connection::Sqlite(tx) => {
                sqlx::query(statement).execute(&mut **tx).await.unwrap();
            }
            Connection::Postgres(tx) => {
                sqlx::query(statement).execute(&mut **tx).await.unwrap();
            }
        }
        tx.commit().await.unwrap();
    }

    /// Returns the kinds of all live events so far, in order.
    pub async fn events(&self) -> Vec<String> {
        let sql = "SELECT kind FROM events ORDER BY id";
        match self.app.db.pools() {
            Pools::Sqlite { readers, .. } => sqlx::query_scalar(sql).fetch_all(readers).await,
            Pools::Postgres(pool) => sqlx::query_scalar(sql).fetch_all(pool).await,
        }
        .unwrap()
    }

    /// Runs every job that is due now.
    pub async fn work(&self) -> Vec<Worked> {
        let mut done = Vec::new();
        while let Some(worked) = worker::step(&self.app).await.unwrap() {
            done.push(worked);
        }
        done
    }

    /// Advances the clock.
    pub fn advance(&self, seconds: f64) {
        self.app.clock.advance(seconds);
    }
}

/// A database that the test fills before the server opens it.
pub struct Prepared {
    /// Connection to the database.
    pub db: Db,
    database: Database,
}

impl Prepared {
    /// Starts the server on it.
    pub async fn open(self) -> TestServer {
        self.db.close().await;
        let clock = Clock::manual(Timestamp::parse(START).unwrap());
        TestServer::open(self.database, clock, &[]).await
    }

    /// Removes the database.
    pub async fn remove(self) {
        self.db.close().await;
        self.database.remove().await;
    }
}

fn config(url: &str, settings: &[&str]) -> Serve {
    let arguments = ["binnacle-server", "serve", "--database-url", url];
    let more = [
        "--listen",
        "127.0.0.1:0",
        "--analysis-workers",
        "0",
        "--webhooks-to-private",
        "--mail-from",
        "Binnacle <alerts@binnacle.example>",
    ];
    let public: &[&str] = if settings.contains(&"--public-url") {
        &[]
    } else {
        &["--public-url", "https://binnacle.example"]
    };
    let relay: &[&str] = if settings.contains(&"--smtp-url") {
        &[]
    } else {
        &["--smtp-url", "smtp://localhost:9?tls=none"]
    };
    let all = arguments
        .into_iter()
        .chain(more)
        .chain(relay.iter().copied())
        .chain(public.iter().copied())
        .chain(settings.iter().copied());
    let Command::Serve(serve) = Cli::parse_from(all).command else {
        unreachable!("serve was asked for");
    };
    *serve
}

/// Returns the metrics recorder, of which a process has one.
fn metrics() -> PrometheusHandle {
    static HANDLE: OnceLock<PrometheusHandle> = OnceLock::new();
    HANDLE
        .get_or_init(|| health::install_metrics().unwrap())
        .clone()
}

/// Returns a client that does not follow redirects.
pub fn client() -> reqwest::Client {
    // Only the first test can install it; reqwest needs a provider also for http.
    let _ = rustls::crypto::ring::default_provider().install_default();
    reqwest::Client::builder()
        .redirect(reqwest::redirect::Policy::none())
        .build()
        .unwrap()
}
