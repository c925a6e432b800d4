//! Fleet: operators, vessels, compasses, their samples, models, alerts and documents.

#![allow(
    clippy::missing_errors_doc,
    reason = "a function that asks the database errs when that does; others say more"
)]
#![allow(
    clippy::cast_possible_wrap,
    reason = "counts go into BIGINT and are far from its end"
)]

pub mod event_kinds;

pub mod binnacles;
pub mod compasses;
pub mod fleet_views;
pub mod operators;
pub mod overview;
pub mod particulars;
pub mod settings;
pub mod tags;
pub mod vessel_api;
pub mod vessels;

pub mod agent_auth;
pub mod enrolment;
pub mod ingest;
pub mod samples;

pub mod adjustments;
pub mod alerts;
pub mod analysis;
pub mod analysis_queue;
pub mod changes;
pub mod deviation;
pub mod deviation_table;
pub mod models;

pub mod azimuths;
pub mod logbook;
