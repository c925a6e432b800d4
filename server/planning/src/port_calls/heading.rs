//! Heading of a vessel at a berth: given, read alongside, or learnt from earlier calls.
//!
//! Invariant: headings are learnt from calls of the operator's own fleet only.

use super::call::{CallBerthHeading, CallBerthHeadingSource, Content};
use anyhow::Context;
use binnacle_platform::db::{Db, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::OperatorId;
use binnacle_platform::time::Time;
use binnacle_schedule::calls::{Observed, berth_heading};
use binnacle_schedule::ports::PortCode;

/// Maximum number of earlier calls to learn from, the latest.
const MAX_CALLS: i64 = 2000;

/// Headings of a fleet's earlier calls.
pub struct EarlierHeadings(Vec<Observed>);

impl EarlierHeadings {
    /// Loads the known headings of a fleet's calls that have begun.
    pub async fn of_fleet(db: &Db, operator: OperatorId, now: Time) -> Result<EarlierHeadings> {
        let found = rows!(
            db,
            (String, Option<String>, f64),
            "SELECT c.port, c.berth, COALESCE(c.lay_heading_deg, c.berth_heading_deg)
             FROM port_calls c JOIN vessels v ON v.id = c.vessel_id
             WHERE v.operator_id = $1 AND c.eta <= $2 AND c.withdrawn_at IS NULL
               AND COALESCE(c.lay_heading_deg, c.berth_heading_deg) IS NOT NULL
             ORDER BY c.eta DESC, c.id
             LIMIT $3",
            operator,
            now,
            MAX_CALLS
        )?;
        let read = |(port, berth, heading_deg): (String, Option<String>, f64)| {
            Ok(Observed {
                port: PortCode::parse(&port).context("stored port")?,
                berth,
                heading_deg,
            })
        };
        let observed: Result<Vec<Observed>> = found.into_iter().map(read).collect();
        Ok(EarlierHeadings(observed?))
    }
}

/// Returns the heading of the vessel alongside. A reading there takes precedence over a given one.
pub fn heading_alongside(
    call: &Content,
    lay_deg: Option<f64>,
    earlier: &EarlierHeadings,
) -> Option<CallBerthHeading> {
    if let Some(heading_deg) = lay_deg {
        let source = CallBerthHeadingSource::Read;
        return Some(CallBerthHeading {
            heading_deg,
            source,
        });
    }
    berth_heading(&call.to_schedule_call("", ""), &earlier.0).map(CallBerthHeading::from)
}
