//! The shore server: ingest, analysis, API, dashboard host, and the science on
//! the command line.
//!
//! One folder or file for each thing it can do; in reading order:

#![allow(
    clippy::missing_errors_doc,
    reason = "a function that asks the database errs when that does; others say more"
)]
#![allow(
    clippy::cast_possible_wrap,
    reason = "counts go into BIGINT and are far from its end"
)]

pub mod app;
pub mod clock;
pub mod config;
pub mod db;
pub mod error;
pub mod ids;
pub mod severity;
pub mod time;

pub mod access;
pub mod audit;
pub mod ed25519;
pub mod firms;
pub mod idempotency;
pub mod oidc;
pub mod operators;
pub mod password;
pub mod peer;
pub mod second_factor;
pub mod secret;
pub mod session;
pub mod tenants;
pub mod tokens;
pub mod users;

pub mod binnacles;
pub mod compasses;
pub mod fleet;
pub mod logbook;
pub mod particulars;
pub mod settings;
pub mod vessels;

pub mod enrolment;
pub mod streams;

pub mod adjustments;
pub mod alerts;
pub mod analysis;
pub mod changes;
pub mod deviation;
pub mod events;
pub mod models;
pub mod samples;

pub mod needs;
pub mod port_calls;
pub mod schedule;

pub mod calendar;
pub mod evidence;
pub mod work_orders;

pub mod card;
pub mod deviation_book;
pub mod sheet;

pub mod mail;
pub mod notices;
pub mod notifications;
pub mod outbox;
pub mod reports;
pub mod webhooks;

pub mod dashboard;
pub mod http;
pub mod operations;
pub mod state;
pub mod subscriptions;
pub mod tls;

pub mod command;
