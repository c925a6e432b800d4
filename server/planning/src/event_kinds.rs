//! Kinds of live events about port calls and the schedule.

use binnacle_platform::events::Kind;

/// A port call was entered, amended or withdrawn.
pub const PORT_CALL: Kind = Kind::new("port_call");
/// The schedule of the vessel has changed.
pub const SCHEDULE: Kind = Kind::new("schedule");
