//! Links between a ship and a server.

pub mod gateway;
pub mod satellite;
