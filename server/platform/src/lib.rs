//! Platform of the server: database, errors, HTTP kit, identity, audit log, messages, events.
//!
//! It knows no domain: what a domain refuses, announces or reacts to reaches it as a
//! [`error::DomainProblem`], a message, or a handler of an event.

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
pub mod outage;
pub mod severity;
pub mod signing_keys;
pub mod time;

pub mod access;
pub mod audit;
pub mod audit_api;
pub mod client_address;
pub mod ed25519;
pub mod idempotency;
pub mod identity_provider;
pub mod oidc;
pub mod password;
pub mod quotas;
pub mod quotas_api;
pub mod request_rates;
pub mod seal_rotation;
pub mod sealing;
pub mod second_factor;
pub mod secret;
pub mod session;
pub mod session_api;
pub mod sign_in_watch;
pub mod tenants;
pub mod tokens;
pub mod users;

pub mod event_stream;
pub mod events;
pub mod mail;
pub mod notices;
pub mod outbox;
pub mod webhooks;

pub mod http;
pub mod outbound;
pub mod tls;
