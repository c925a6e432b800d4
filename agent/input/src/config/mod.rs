//! `[inputs.NAME]`: what an input reads.

mod baud;
mod host_port;
mod input;
mod n2k_input;
mod signalk;

pub use host_port::HostPort;
pub use input::{AddressOwner, Group, InputConfig, SerialConfig};
pub use n2k_input::{ActisenseConfig, YdwgConfig};
pub use signalk::SignalKConfig;
