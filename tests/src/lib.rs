//! Shared parts of the end-to-end tests of the real programs.
//!
//! The tests start the server, agents and the simulator as processes, as users
//! would, on loopback ports chosen by the system, and kill them. No test is
//! skipped: a missing program or database fails the test with advice.

pub mod at_sea;
pub mod coast;
pub mod database;
pub mod eventually;
pub mod feed;
pub mod gateway;
pub mod heard;
pub mod ledger;
pub mod namespace;
pub mod program;
pub mod satellite;
pub mod ship;
pub mod shore;
pub mod voyage;

pub use at_sea::AtSea;
pub use coast::{Coast, Passage};
pub use database::{Database, Engine};
pub use eventually::eventually;
pub use feed::{Feed, Pace, Progress};
pub use program::{Program, output_of};
pub use satellite::Satellite;
pub use ship::Ship;
pub use shore::Shore;
pub use voyage::{Truth, Voyage};
