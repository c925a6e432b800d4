//! Cost of a batch, in statements of the database.

use super::DAY;
use binnacle_server_testing::{Engine, TestServer, passage};
use std::sync::{Arc, Mutex};
use tracing::field::{Field, Visit};
use tracing::{Event, Subscriber};
use tracing_subscriber::layer::{Context, Layer, SubscriberExt};
use tracing_subscriber::registry::Registry;

/// Beginnings of what is no statement of a batch: the transaction itself, and the announcement of
/// earlier events.
const OTHERS: [&str; 3] = ["BEGIN", "COMMIT", "SELECT pg_notify"];

/// Statements that this thread has run.
#[derive(Clone, Default)]
struct Statements(Arc<Mutex<Vec<String>>>);

impl<S: Subscriber> Layer<S> for Statements {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        if event.metadata().target() == "sqlx::query" {
            event.record(&mut self.clone());
        }
    }
}

impl Visit for Statements {
    fn record_str(&mut self, field: &Field, value: &str) {
        if field.name() == "summary" && !OTHERS.iter().any(|other| value.starts_with(other)) {
            self.0.lock().unwrap().push(value.to_owned());
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
    let statements = Statements::default();
    let subscriber = Registry::default().with(statements.clone());
    let recording = tracing::subscriber::set_default(subscriber);
    nao.put(2, &passage("2026-11-20T06:00:00Z", 3)).await.good();
    drop(recording);
    let statements = statements.0.lock().unwrap().clone();
    assert_eq!(statements.len(), 6, "{statements:#?}");
    server.finish().await;
}
