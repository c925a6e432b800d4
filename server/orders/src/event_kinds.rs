//! Kinds of live events about work orders.

use binnacle_platform::events::Kind;

/// A work order has changed.
pub const WORK_ORDER: Kind = Kind::new("work_order");
