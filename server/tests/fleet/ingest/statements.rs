//! Cost of a batch, in statements of the database.

use super::DAY;
use binnacle_server_testing::{Engine, TestServer, passage};
use std::cell::RefCell;
use tracing::field::{Field, Visit};
use tracing::{Event, Subscriber};
use tracing_subscriber::layer::{Context, Layer, SubscriberExt};
use tracing_subscriber::registry::Registry;

/// Beginnings of what is no statement of a batch: the transaction itself, and the announcement of
/// earlier events.
const OTHERS: [&str; 3] = ["BEGIN", "COMMIT", "SELECT pg_notify"];

thread_local! {
    /// Statements that this thread has run since it began to record, `None` while it does not.
    static STATEMENTS: RefCell<Option<Vec<String>>> = const { RefCell::new(None) };
}

/// Records statements on the threads that ask for it. It is the subscriber of the whole process,
/// for one of a single thread misses what another thread has run first.
struct Recorder;

impl<S: Subscriber> Layer<S> for Recorder {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        if event.metadata().target() == "sqlx::query" {
            event.record(&mut Recorder);
        }
    }
}

impl Visit for Recorder {
    fn record_str(&mut self, field: &Field, value: &str) {
        if field.name() == "summary" && !OTHERS.iter().any(|other| value.starts_with(other)) {
            STATEMENTS.with_borrow_mut(|statements| {
                if let Some(statements) = statements {
                    statements.push(value.to_owned());
                }
            });
        }
    }

    fn record_debug(&mut self, _: &Field, _: &dyn std::fmt::Debug) {}
}

/// The statements are the same on SQLite, which runs them on a thread of its own.
#[tokio::test]
async fn a_batch_in_order_takes_six_statements() {
    let server = TestServer::start(Engine::Postgres).await;
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 3)).await.good();
    tracing::subscriber::set_global_default(Registry::default().with(Recorder)).unwrap();
    STATEMENTS.set(Some(Vec::new()));
    nao.put(2, &passage("2026-11-20T06:00:00Z", 3)).await.good();
    let statements = STATEMENTS.take().unwrap();
    assert_eq!(statements.len(), 6, "{statements:#?}");
    server.finish().await;
}
