//! The simulator through its public face: ships, sentences, scenarios, commands.

mod commands;
mod instruments;
mod line;
mod scenarios;
mod support;
mod voyages;
