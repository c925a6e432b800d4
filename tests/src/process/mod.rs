//! Processes under test, and what they need of the system.

pub mod database;
pub mod namespace;
pub mod postgres;
pub mod program;
