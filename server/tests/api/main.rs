//! The server as others see it: over real HTTP, on both databases.
//!
//! PostgreSQL comes from `BINNACLE_TEST_POSTGRES`, the URL of a server on which
//! each test makes a database of its own; without it the tests fail, they are
//! never skipped. Run them through `make test` or `scripts/with-postgres`.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

mod support;

mod alerts;
mod analysis;
mod analysis_jobs;
mod at_a_glance;
mod audit;
mod authorisation;
mod binnacles;
mod bursts;
mod calendar;
mod card;
mod changes;
mod commands;
mod dashboard;
mod deviation_book;
mod document;
mod documented;
mod enrolment;
mod events;
mod firms;
mod fit;
mod fleet;
mod headers;
mod ingest;
mod logbook;
mod logbook_effects;
mod mail;
mod mail_tls;
mod mail_tries;
mod migration;
mod notifications;
mod offers;
mod out_of_service;
mod people;
mod plan;
mod planning;
mod port_calls;
mod reports;
mod schedule;
mod second_factor;
mod secrets;
mod sessions;
mod ship_alerts;
mod sign_in_provider;
mod slow_receivers;
mod tenants;
mod tls;
mod webhooks;
mod work_orders;

/// Runs each test on SQLite and on PostgreSQL.
macro_rules! on_both {
    ($($test:ident),* $(,)?) => {
        mod sqlite {
            $(#[tokio::test]
            async fn $test() {
                super::$test(crate::support::Shore::start(crate::support::Engine::Sqlite).await).await;
            })*
        }
        mod postgres {
            $(#[tokio::test]
            async fn $test() {
                super::$test(crate::support::Shore::start(crate::support::Engine::Postgres).await).await;
            })*
        }
    };
}
pub(crate) use on_both;
