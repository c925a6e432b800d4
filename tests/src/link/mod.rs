//! Links between a ship and a server.

pub mod chains;
pub mod gateway;
pub mod relay;
pub mod satellite;
