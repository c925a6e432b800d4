//! Kinds of live events about a vessel, its compasses and its alerts.

use binnacle_platform::events::Kind;

/// A batch was received.
pub const BATCH: Kind = Kind::new("batch");
/// A compass has a new model.
pub const MODEL: Kind = Kind::new("model");
/// Something was reported, amended or withdrawn.
pub const LOGBOOK: Kind = Kind::new("logbook");
/// An alert was raised, updated, acknowledged or cleared.
pub const ALERT: Kind = Kind::new("alert");
/// A compass needs adjustment soon, or sooner than before.
pub const NEED: Kind = Kind::new("need");
