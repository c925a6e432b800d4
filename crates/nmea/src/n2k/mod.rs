//! NMEA 2000: frames of a CAN bus, fast packets, and the parameter groups that a compass needs.
//!
//! Layouts and units of the parameter groups are those of canboat's published database
//! (canboat.github.io/canboat, PGN reference), the framing that of ISO 11783-3 and -5.
//!
//! - [`Frame`] is a frame of at most eight bytes. [`Assembler`] makes [`Message`]s of frames.
//! - [`Data::parse`] reads a message, [`VesselHeading`] and [`variation_message`] make one.
//! - [`text`] and [`actisense`] read what gateways send and loggers store.
//! - [`AddressClaim`] claims an address, as every sender must.

pub mod actisense;
mod claim;
mod data;
mod device;
mod fast_packet;
mod fields;
mod frame;
mod heading;
mod identity;
pub mod text;

pub use claim::{AddressClaim, CLAIM_TIME, ClaimState};
pub use data::{Data, FixMethod, Reference};
pub use device::{Device, HEARTBEAT_INTERVAL};
pub use fast_packet::{Assembler, split};
pub use frame::{Frame, Header, Message, is_network_management};
pub use heading::{VesselHeading, variation_message};
pub use identity::{Address, Name};
