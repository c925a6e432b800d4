//! Shared parts of the end-to-end tests of the real programs.
//!
//! The tests start the server, agents and the simulator as processes, as users
//! would, on loopback ports chosen by the system, and kill them. No test is
//! skipped: a missing program or database fails the test with advice.

pub mod autopilot;
pub mod eventually;
pub mod feed;
pub mod link;
pub mod process;
pub mod records;
pub mod sailing;
pub mod server_process;
pub mod ship;
pub mod ship_and_server;
pub mod ship_on_link;
pub mod uploader;
pub mod voyage;

pub use eventually::eventually;
pub use feed::{Feed, Pace, Progress};
pub use link::satellite::Satellite;
pub use process::database::{Database, Engine};
pub use process::program::{Program, output_of};
pub use server_process::ServerProcess;
pub use ship::Ship;
pub use ship_and_server::{Setup, ShipAndServer};
pub use ship_on_link::ShipOnLink;
pub use uploader::Uploader;
pub use voyage::{Truth, Voyage};
