//! Support for the tests of the server over HTTP.
//!
//! Each test has a server and a database of its own, and clients that talk to it.
//!
//! PostgreSQL comes from `BINNACLE_TEST_POSTGRES`, the URL of a server on which
//! each test makes a database of its own; without it the tests fail, they are
//! never skipped. Run them through `make test` or `scripts/with-postgres`.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test fails by a panic"
)]

pub mod alerts;
pub mod binnacles;
mod database;
pub mod mail;
pub mod offers;
mod person;
pub mod port_calls;
pub mod program;
mod provider;
mod relay;
mod server;
mod ship;
pub mod webhooks;
pub mod work_orders;

pub use database::{Engine, Proxy};
pub use person::{ApiResponse, Person, password_hash, patch, try_sign_in};
pub use provider::{CLIENT_SECRET, Provider, Signer, provider_settings};
pub use relay::{Behaviour, Encryption, Letter, Relay, Stage};
pub use server::{DAY_S, HOUR_S, PASSWORD, Prepared, START, TestServer, client};
pub use ship::{
    Ship, days_at_sea, days_in_waters, enrol_with_code, frame, model_after_step, passage, position,
    sample, sun_by_azimuth, true_model,
};

/// Runs each test on SQLite and on PostgreSQL.
#[macro_export]
macro_rules! on_both {
    ($($test:ident),* $(,)?) => {
        mod sqlite {
            $(#[tokio::test]
            async fn $test() {
                super::$test($crate::TestServer::start($crate::Engine::Sqlite).await).await;
            })*
        }
        mod postgres {
            $(#[tokio::test]
            async fn $test() {
                super::$test($crate::TestServer::start($crate::Engine::Postgres).await).await;
            })*
        }
    };
}
